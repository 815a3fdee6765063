#include "accel/point_query.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "accel/batch_pieces.h"
#include "accel/code.h"
#include "accel/csg/csg.h"
#include "accel/hit_place.h"
#include "accel/instance.h"
#include "kernels/exact_form.h"
#include "kernels/exact_ops.h"

namespace oktett {

// ---- Which points are inside: by the crossings of one ray from each point, which are counted once.

namespace {

/// Answers for one structure. A point is inside of a solid if a ray from it crosses the boundary an odd
/// number of times. Unbounded solids differ: a shape is judged by its function, and a combination
/// by whether the far end of the ray is inside of it.
class InsideTest {
 public:
  InsideTest(const Accel& accel, Isa isa);

  /// answers[i] becomes 1 if points[i] is inside of any solid, else 0. Any number of threads may call it.
  void operator()(const PointSpan& points, std::uint8_t* answers) const;

 private:
  /// A solid without bounds.
  struct Unbounded {
    const Accel* accel;
    std::uint32_t geometry, instance, item;
    bool is_combination;
    Affine to_here;  ///< from the space of the structure that is queried
  };

  void find_unbounded(const Accel& accel, const Affine& to_here, std::uint32_t instance);
  /// Whether the ray begins inside of any solid, given all its hits.
  bool is_inside(const Ray& ray, std::span<const Hit> hits) const;

  const Accel& accel_;
  Isa isa_;
  bool is_one_mesh_;
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

InsideTest::InsideTest(const Accel& accel, Isa isa)
    : accel_(accel),
      isa_(isa),
      is_one_mesh_(accel.kinds.size() == 1 && static_cast<Kind>(accel.kinds[0]) == Kind::triangle) {
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

bool InsideTest::is_inside(const Ray& ray, std::span<const Hit> hits) const {
  if (is_one_mesh_) return hits.size() % 2 == 1;
  // A solid, and whether its crossings count.
  struct Crossed {
    std::uint32_t instance, item;
    bool operator==(const Crossed&) const = default;
    bool operator<(const Crossed& b) const {
      return instance != b.instance ? instance < b.instance : item < b.item;
    }
  };
  static thread_local std::vector<Crossed> crossed;
  crossed.clear();
  for (const Hit& hit : hits) {
    const CrossedSolid solid = crossed_solid(accel_, hit);
    if (has_inside(*solid.accel, solid.geometry)) crossed.push_back({solid.instance, solid.item});
  }
  for (const Unbounded& u : unbounded_) {
    const bool runs = runs_inside(*u.accel, u.geometry, moved_ray(u.to_here, ray));
    const Crossed solid{u.instance, u.item};
    if (!u.is_combination) {
      if (runs) return true;
      std::erase(crossed, solid);
    } else if (runs) {
      crossed.push_back(solid);
    }
  }
  std::sort(crossed.begin(), crossed.end());
  for (std::size_t i = 0; i < crossed.size();) {
    const std::size_t first = i;
    while (i < crossed.size() && crossed[i] == crossed[first]) ++i;
    if ((i - first) % 2 == 1) return true;
  }
  return false;
}

void InsideTest::operator()(const PointSpan& points, std::uint8_t* answers) const {
  static thread_local RayBatch rays;
  static thread_local HitLists lists;
  static thread_local std::vector<std::size_t> tested;
  tested.clear();
  for (std::size_t i = 0; i < points.size; ++i) {
    answers[i] = 0;
    const Vec3f p = points[i];
    if (is_finite(p) && (!unbounded_.empty() || accel_.bounds.contains(p))) tested.push_back(i);
  }
  rays.resize_uninitialized(tested.size());
  for (std::size_t k = 0; k < tested.size(); ++k) rays.set(k, {points[tested[k]], 0, kDirection});
  all_hits(accel_, rays.span(), lists, isa_);
  for (std::size_t k = 0; k < tested.size(); ++k) answers[tested[k]] = is_inside(rays[k], lists.of_ray(k));
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
void find_inside(const Accel& accel, const Points& points, std::span<std::uint8_t> answers, Isa isa) {
  const InsideTest test(accel, isa);
  for_each_points(answers.size(), [&](std::size_t begin, std::size_t end) {
    test(point_columns(points, begin, end - begin), answers.data() + begin);
  });
}

template <class Points>
void find_distances(const Accel& accel, const Points& points, std::span<float> distances, Isa isa) {
  require_closest(accel, "signed_distance");
  const PointCode& code = point_code(isa);
  const InsideTest test(accel, isa);
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

void inside(const Accel& accel, const PointSpan& points, std::span<std::uint8_t> answers, Isa isa) {
  require_same_size(points.size, answers.size(), "inside", "points");
  find_inside(accel, points, answers, isa);
}

void inside(const Accel& accel, std::span<const Vec3f> points, std::span<std::uint8_t> answers, Isa isa) {
  require_same_size(points.size(), answers.size(), "inside", "points");
  find_inside(accel, points, answers, isa);
}

bool inside(const Accel& accel, const Vec3f& point, Isa isa) {
  std::uint8_t answer = 0;
  inside(accel, {&point, 1}, {&answer, 1}, isa);
  return answer != 0;
}

void signed_distance(const Accel& accel, const PointSpan& points, std::span<float> distances, Isa isa) {
  require_same_size(points.size, distances.size(), "signed_distance", "points");
  find_distances(accel, points, distances, isa);
}

void signed_distance(const Accel& accel, std::span<const Vec3f> points, std::span<float> distances, Isa isa) {
  require_same_size(points.size(), distances.size(), "signed_distance", "points");
  find_distances(accel, points, distances, isa);
}

float signed_distance(const Accel& accel, const Vec3f& point, Isa isa) {
  float distance = 0;
  signed_distance(accel, {&point, 1}, {&distance, 1}, isa);
  return distance;
}

}  // namespace oktett
