#include "accel/point_query.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "accel/batch_pieces.h"
#include "accel/code.h"
#include "accel/csg/csg.h"
#include "accel/hit_place.h"
#include "accel/instance.h"
#include "accel/query.h"
#include "accel/winding/mesh_sense.h"
#include "accel/winding/winding_field.h"
#include "kernels/exact_form.h"
#include "kernels/exact_ops.h"

namespace oktett {

// ---- Which points are inside: by the crossings of one ray from each point, which are counted once.

namespace {

/// Answers for one structure. A point is inside of a shape if a ray from it crosses the boundary an odd
/// number of times, of a mesh as begins_inside() says, of a combination if the ray leaves it first. Unbounded
/// solids differ: a shape is judged by its function, and a combination that is not crossed by whether the far
/// end of the ray is inside of it.
class InsideTest {
 public:
  /// Meshes count if `meshes`.
  InsideTest(const Accel& accel, Isa isa, bool meshes = true);

  /// answers[i] becomes 1 if points[i] is inside of any solid, else 0. Any number of threads may call it.
  void operator()(const PointSpan& points, std::uint8_t* answers) const {
    count(
        points, [&](std::size_t i, int solids) { answers[i] = solids > 0; }, true);
  }

  /// Calls take(i, n) for each point, inside of n solids; n may be 1 for more if `any`.
  template <class Take>
  void count(const PointSpan& points, Take&& take, bool any) const;

 private:
  /// A solid without bounds.
  struct Unbounded {
    const Accel* accel;
    std::uint32_t geometry, instance, item;
    bool is_combination;
    Affine to_here;  ///< from the space of the structure that is queried
  };

  /// A crossing, and the solid that it is of. Crossings with one solid keep their order.
  struct Crossed {
    std::uint32_t instance, item;
    std::size_t place;
    Crossing crossing;
    const Accel* accel;
    std::uint32_t geometry;

    bool is_of(const Crossed& b) const { return instance == b.instance && item == b.item; }
    bool operator<(const Crossed& b) const {
      if (instance != b.instance) return instance < b.instance;
      return item != b.item ? item < b.item : place < b.place;
    }
  };

  void find_unbounded(const Accel& accel, const Affine& to_here, std::uint32_t instance);
  /// In how many solids the ray begins, given all its crossings; 1 may stand for more if `any`.
  int solids_at(const Ray& ray, std::span<const Crossing> crossings, bool any) const;
  /// Whether the ray begins inside of the solid that all these crossings are of.
  bool begins_in_solid(std::span<const Crossed> crossed) const;

  const Accel& accel_;
  Isa isa_;
  bool meshes_, is_one_mesh_;
  std::vector<Unbounded> unbounded_;
};

/// In no special direction, so that few rays run along edges, faces and axes of symmetry.
constexpr Vec3f kDirection{0.4142f, 0.2718f, 0.8686f};

bool has_inside(const Accel& accel, std::uint32_t geometry) {
  const Geometry& g = accel.geometries[geometry];
  if (const auto* exact = std::get_if<ExactShape>(&g.shape)) return !is_open(*exact);
  return std::visit([]<class T>(const T&) { return !kIsFlat<T>; }, g.shape);
}

/// The item of an entry of Accel::unbounded that is a shape.
std::uint32_t item_of(const Accel& accel, const LeafEntry& leaf) {
  if (is_exact(leaf.kind)) return accel.exact_pool(leaf.kind).item_of_cell(leaf.begin);
  return accel.item_in_pool(leaf.kind, leaf.begin);
}

InsideTest::InsideTest(const Accel& accel, Isa isa, bool meshes)
    : accel_(accel),
      isa_(isa),
      meshes_(meshes),
      is_one_mesh_(meshes && accel.kinds.size() == 1 && static_cast<Kind>(accel.kinds[0]) == Kind::triangle) {
  find_unbounded(accel, Affine{}, kNoId);
}

void InsideTest::find_unbounded(const Accel& accel, const Affine& to_here, std::uint32_t instance) {
  const auto add = [&](std::uint32_t item, bool is_combination) {
    const std::uint32_t geometry = accel.geometry_of(item);
    // A surface may have several cells.
    if (!unbounded_.empty() && unbounded_.back().accel == &accel && unbounded_.back().instance == instance &&
        unbounded_.back().item == item)
      return;
    if (has_inside(accel, geometry))
      unbounded_.push_back({&accel, geometry, instance, item, is_combination, to_here});
  };
  for (const LeafEntry& leaf : accel.unbounded) {
    if (leaf.kind == Kind::csg)
      add(accel.combinations[leaf.begin].item, true);
    else if (!holds_instances(leaf.kind))
      add(item_of(accel, leaf), false);
    else
      each_instance(accel, leaf, [&](const auto& shown, const Accel& child) {
        find_unbounded(child, Affine::from_rows(shown.to_child) * to_here,
                       instance + (outer_path(shown, kNoId) + 1));
        return true;
      });
  }
}

bool InsideTest::begins_in_solid(std::span<const Crossed> crossed) const {
  const auto kind = static_cast<Kind>(crossed[0].accel->kinds[crossed[0].geometry]);
  // A combination may hold open meshes, so that the ray need not leave it as often as it enters.
  if (kind == Kind::csg) return crossed[0].crossing.turn > 0;
  if (kind != Kind::triangle) return crossed.size() % 2 == 1;
  static thread_local std::vector<Crossing> crossings;
  crossings.clear();
  for (const Crossed& c : crossed) crossings.push_back(c.crossing);
  return begins_inside(mesh_sense(*crossed[0].accel, crossed[0].geometry), crossings);
}

int InsideTest::solids_at(const Ray& ray, std::span<const Crossing> crossings, bool any) const {
  if (is_one_mesh_) return begins_inside(mesh_sense(accel_, 0), crossings) ? 1 : 0;
  static thread_local std::vector<Crossed> crossed;
  crossed.clear();
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    const CrossedSolid solid = crossed_solid(accel_, crossings[i].hit);
    const auto kind = static_cast<Kind>(solid.accel->kinds[solid.geometry]);
    // Surfaces in combinations have no inside.
    const bool is_surface = kind == Kind::csg && crossings[i].turn == 0;
    if (has_inside(*solid.accel, solid.geometry) && (meshes_ || kind != Kind::triangle) && !is_surface)
      crossed.push_back({solid.instance, solid.item, i, crossings[i], solid.accel, solid.geometry});
  }
  int solids = 0;
  for (const Unbounded& u : unbounded_) {
    const auto is_of = [&](const Crossed& c) { return c.instance == u.instance && c.item == u.item; };
    if (u.is_combination && std::ranges::any_of(crossed, is_of)) continue;
    std::erase_if(crossed, is_of);
    if (runs_inside(*u.accel, u.geometry, moved_ray(u.to_here, ray))) ++solids;
    if (any && solids > 0) return 1;
  }
  std::sort(crossed.begin(), crossed.end());
  for (std::size_t begin = 0, end; begin < crossed.size(); begin = end) {
    end = begin;
    while (end < crossed.size() && crossed[end].is_of(crossed[begin])) ++end;
    if (begins_in_solid({&crossed[begin], end - begin})) ++solids;
    if (any && solids > 0) return 1;
  }
  return solids;
}

template <class Take>
void InsideTest::count(const PointSpan& points, Take&& take, bool any) const {
  static thread_local RayBatch rays;
  static thread_local CrossingLists lists;
  static thread_local std::vector<std::size_t> tested;
  tested.clear();
  for (std::size_t i = 0; i < points.size; ++i) {
    const Vec3f p = points[i];
    if (is_finite(p) && (!unbounded_.empty() || accel_.bounds.contains(p)))
      tested.push_back(i);
    else
      take(i, 0);
  }
  rays.resize_uninitialized(tested.size());
  for (std::size_t k = 0; k < tested.size(); ++k) rays.set(k, {points[tested[k]], 0, kDirection});
  all_crossings(accel_, rays.span(), lists, isa_);
  for (std::size_t k = 0; k < tested.size(); ++k) take(tested[k], solids_at(rays[k], lists.of_ray(k), any));
}

/// Answers by winding numbers for one structure; shapes and combinations by their crossings.
class WindingTest {
 public:
  WindingTest(const Accel& accel, Isa isa)
      : accel_(accel),
        code_(point_code(isa)),
        others_(accel, isa, false),
        shows_others_(winding_field(accel).shows_others),
        shows_meshes_(!winding_field(accel).empty()) {}

  /// answers[i] becomes 1 if points[i] is inside, else 0. Any number of threads may call it.
  void operator()(const PointSpan& points, std::uint8_t* answers) const {
    if (shows_others_)
      others_(points, answers);
    else
      std::fill_n(answers, points.size, std::uint8_t{0});
    if (!shows_meshes_) return;
    for (std::size_t i = 0; i < points.size; ++i)
      if (answers[i] == 0 && is_finite(points[i])) answers[i] = winds_around(accel_, points[i], code_);
  }

  /// Winding numbers, off by at most `error`.
  void numbers(const PointSpan& points, float* numbers, double error) const {
    std::fill_n(numbers, points.size, 0.0f);
    if (shows_others_)
      others_.count(
          points, [&](std::size_t i, int n) { numbers[i] = static_cast<float>(n); }, false);
    for (std::size_t i = 0; i < points.size; ++i) {
      if (!is_finite(points[i]))
        numbers[i] = std::numeric_limits<float>::quiet_NaN();
      else if (shows_meshes_)
        numbers[i] = static_cast<float>(static_cast<double>(numbers[i]) +
                                        winding_within(accel_, points[i], error, code_));
    }
  }

 private:
  const Accel& accel_;
  const PointCode& code_;
  InsideTest others_;
  bool shows_others_, shows_meshes_;
};

/// Calls f(test) with the test of a rule.
template <class Function>
void with_test(const Accel& accel, InsideRule rule, Isa isa, Function&& f) {
  if (rule == InsideRule::winding)
    f(WindingTest(accel, isa));
  else
    f(InsideTest(accel, isa));
}

}  // namespace

// ---- Queries

namespace {

/// Larger batches are answered in pieces of this size, each a task.
constexpr std::size_t kPiecePoints = 1024;

/// Calls answer(begin, end) for each piece of a batch.
template <class Answer>
void for_each_points(std::size_t size, Answer&& answer) {
  if (size <= kPiecePoints) return answer(std::size_t{0}, size);
  for_each_task((size + kPiecePoints - 1) / kPiecePoints,
                [&](std::size_t k) { answer(k * kPiecePoints, std::min(size, (k + 1) * kPiecePoints)); });
}

void require_closest(const Accel& accel, const char* query) {
  if (accel.no_closest_point[0].empty()) return;
  std::string others = "mesh";
  for (int k = 0; k < kKinds; ++k) {
    const auto kind = static_cast<Kind>(k);
    if (is_closed_form(kind) || (is_exact(kind) && exact_ops(kind).closest != nullptr))
      others += std::string(", ") + name_of(kind);
  }
  throw Error(std::string(query) + ": " + accel.no_closest_point[0] +
              " has no nearest points; these have: " + others + ". Ask it with rays or with inside()");
}

/// The points from number `begin` on, in columns. They are valid until the thread's next call.
PointSpan point_columns(std::span<const Vec3f> points, std::size_t begin, std::size_t count) {
  static thread_local std::vector<float> columns[3];
  PointSpan span{{}, count};
  for (int k = 0; k < 3; ++k) {
    columns[k].resize(count);
    for (std::size_t i = 0; i < count; ++i) columns[k][i] = points[begin + i][k];
    span.p[k] = columns[k].data();
  }
  return span;
}

PointSpan point_columns(const PointSpan& points, std::size_t begin, std::size_t count) {
  return points.part(begin, count);
}

/// Calls take(i, Nearest) for each point.
template <class Points, class Take>
void find_nearest(const Accel& accel, const Points& points, std::size_t size, Isa isa, Take&& take) {
  const PointCode& code = point_code(isa);
  for_each_points(size, [&](std::size_t begin, std::size_t end) {
    Nearest nearest[kPiecePoints];
    code.closest(accel, point_columns(points, begin, end - begin), nearest);
    for (std::size_t i = begin; i < end; ++i) take(i, nearest[i - begin]);
  });
}

template <class Points>
void find_inside(const Accel& accel, const Points& points, std::span<std::uint8_t> answers, InsideRule rule,
                 Isa isa) {
  with_test(accel, rule, isa, [&](const auto& test) {
    for_each_points(answers.size(), [&](std::size_t begin, std::size_t end) {
      test(point_columns(points, begin, end - begin), answers.data() + begin);
    });
  });
}

template <class Points>
void find_numbers(const Accel& accel, const Points& points, std::span<float> numbers, double error, Isa isa) {
  if (!(error >= 0x1p-20))
    throw Error(fmt::format("winding_number: the error must be at least 2^-20, not {}", error));
  const WindingTest test(accel, isa);
  for_each_points(numbers.size(), [&](std::size_t begin, std::size_t end) {
    test.numbers(point_columns(points, begin, end - begin), numbers.data() + begin, error);
  });
}

template <class Points>
void find_distances(const Accel& accel, const Points& points, std::span<float> distances, InsideRule rule,
                    Isa isa) {
  require_closest(accel, "signed_distance");
  const PointCode& code = point_code(isa);
  with_test(accel, rule, isa, [&](const auto& test) {
    for_each_points(distances.size(), [&](std::size_t begin, std::size_t end) {
      Nearest nearest[kPiecePoints];
      std::uint8_t answers[kPiecePoints];
      const PointSpan columns = point_columns(points, begin, end - begin);
      code.closest(accel, columns, nearest);
      test(columns, answers);
      for (std::size_t i = begin; i < end; ++i) {
        const float distance = distance_of(nearest[i - begin]);
        distances[i] = answers[i - begin] != 0 ? -distance : distance;
      }
    });
  });
}

}  // namespace

void closest_point(const Accel& accel, const PointSpan& points, const ClosestPointSpan& closest, Isa isa) {
  require_same_size(points.size, closest.size, "closest_point", "points");
  require_closest(accel, "closest_point");
  find_nearest(accel, points, points.size, isa, [&](std::size_t i, const Nearest& nearest) {
    closest.set(i, closest_surface(accel, points[i], nearest));
  });
}

void closest_point(const Accel& accel, std::span<const Vec3f> points, std::span<ClosestPoint> closest,
                   Isa isa) {
  require_same_size(points.size(), closest.size(), "closest_point", "points");
  require_closest(accel, "closest_point");
  find_nearest(accel, points, points.size(), isa, [&](std::size_t i, const Nearest& nearest) {
    closest[i] = closest_surface(accel, points[i], nearest);
  });
}

ClosestPoint closest_point(const Accel& accel, const Vec3f& point, Isa isa) {
  ClosestPoint closest;
  closest_point(accel, {&point, 1}, {&closest, 1}, isa);
  return closest;
}

void inside(const Accel& accel, const PointSpan& points, std::span<std::uint8_t> answers, InsideRule rule,
            Isa isa) {
  require_same_size(points.size, answers.size(), "inside", "points");
  find_inside(accel, points, answers, rule, isa);
}

void inside(const Accel& accel, std::span<const Vec3f> points, std::span<std::uint8_t> answers,
            InsideRule rule, Isa isa) {
  require_same_size(points.size(), answers.size(), "inside", "points");
  find_inside(accel, points, answers, rule, isa);
}

bool inside(const Accel& accel, const Vec3f& point, InsideRule rule, Isa isa) {
  std::uint8_t answer = 0;
  inside(accel, {&point, 1}, {&answer, 1}, rule, isa);
  return answer != 0;
}

void inside(const Accel& accel, const PointSpan& points, std::span<std::uint8_t> answers, Isa isa) {
  inside(accel, points, answers, InsideRule::crossings, isa);
}

void inside(const Accel& accel, std::span<const Vec3f> points, std::span<std::uint8_t> answers, Isa isa) {
  inside(accel, points, answers, InsideRule::crossings, isa);
}

bool inside(const Accel& accel, const Vec3f& point, Isa isa) {
  return inside(accel, point, InsideRule::crossings, isa);
}

void winding_number(const Accel& accel, const PointSpan& points, std::span<float> numbers, double error,
                    Isa isa) {
  require_same_size(points.size, numbers.size(), "winding_number", "points");
  find_numbers(accel, points, numbers, error, isa);
}

void winding_number(const Accel& accel, std::span<const Vec3f> points, std::span<float> numbers, double error,
                    Isa isa) {
  require_same_size(points.size(), numbers.size(), "winding_number", "points");
  find_numbers(accel, points, numbers, error, isa);
}

float winding_number(const Accel& accel, const Vec3f& point, double error, Isa isa) {
  float number = 0;
  winding_number(accel, {&point, 1}, {&number, 1}, error, isa);
  return number;
}

void signed_distance(const Accel& accel, const PointSpan& points, std::span<float> distances, InsideRule rule,
                     Isa isa) {
  require_same_size(points.size, distances.size(), "signed_distance", "points");
  find_distances(accel, points, distances, rule, isa);
}

void signed_distance(const Accel& accel, std::span<const Vec3f> points, std::span<float> distances,
                     InsideRule rule, Isa isa) {
  require_same_size(points.size(), distances.size(), "signed_distance", "points");
  find_distances(accel, points, distances, rule, isa);
}

float signed_distance(const Accel& accel, const Vec3f& point, InsideRule rule, Isa isa) {
  float distance = 0;
  signed_distance(accel, {&point, 1}, {&distance, 1}, rule, isa);
  return distance;
}

void signed_distance(const Accel& accel, const PointSpan& points, std::span<float> distances, Isa isa) {
  signed_distance(accel, points, distances, InsideRule::crossings, isa);
}

void signed_distance(const Accel& accel, std::span<const Vec3f> points, std::span<float> distances, Isa isa) {
  signed_distance(accel, points, distances, InsideRule::crossings, isa);
}

float signed_distance(const Accel& accel, const Vec3f& point, Isa isa) {
  return signed_distance(accel, point, InsideRule::crossings, isa);
}

}  // namespace oktett
