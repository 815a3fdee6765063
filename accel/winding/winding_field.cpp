#include "accel/winding/winding_field.h"

#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>

#include "accel/instance.h"
#include "accel/winding/mesh_sense.h"
#include "accel/winding/winding_sum.h"
#include "core/math.h"
#include "core/parallel.h"

namespace oktett {

const float kWindingAtan[8] = {-0x1.09b85p-8f,  0x1.6633dcp-6f, -0x1.ca08a0p-5f, 0x1.8af1c2p-4f,
                               -0x1.1cd946p-3f, 0x1.988174p-3f, -0x1.554c3ap-2f, 0x1.ffffeap-1f};

void OpenParts::push(std::uint32_t part) { list.push_back(part); }

// ---- The surfaces of a structure.

namespace {

/// Calls take(corners) for the triangles of a structure's own meshes as they are traced, the outside in
/// front. Left out are those that are not finite or have two equal corners: nothing is seen of them.
template <class Take>
void each_triangle(const Accel& accel, Take&& take) {
  for (std::size_t g = 0; g < accel.geometries.size(); ++g) {
    const Geometry& geometry = accel.geometries[g];
    const auto* shape = std::get_if<MeshGeometry>(&geometry.shape);
    if (shape == nullptr || !geometry.transform.is_invertible()) continue;
    const TriangleMesh& mesh = *shape->mesh;
    const GeometryFrame& frame = accel.frames[g];
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
      WindingTriangle triangle;
      bool finite = true;
      for (std::size_t k = 0; k < 3; ++k) {
        Vec3f& corner = triangle.corner[k];
        corner = mesh.positions[mesh.indices[3 * t + k]];
        if (!frame.identity) corner = Vec3f(geometry.transform.point(Vec3d(corner)));
        finite &= is_finite(corner);
      }
      auto& [a, b, c] = triangle.corner;
      if (!finite || a == b || b == c || c == a) continue;
      if (frame.mirrored) std::swap(b, c);
      take(triangle);
    }
  }
}

/// Calls take(part) for the instances of a structure.
template <class Take>
void each_part(const Accel& accel, Take&& take) {
  for (const InstanceItem& i : accel.instances)
    take(WindingPart{i.child, Affine::from_rows(i.to_child),
                     accel.geometries[accel.geometry_of(i.item)].transform});
  for (const ListedInstance& i : accel.listed_instances) {
    const Affine to_child = Affine::from_rows(i.to_child);
    take(WindingPart{accel.listed_children[i.child], to_child, to_child.inverse()});
  }
}

/// Surfaces with more open edges than this are not capped.
constexpr std::size_t kMostCaps = 1u << 13;

/// An edge of a triangle, by the numbers of its ends, the lower first.
struct WindingEdge {
  std::uint64_t low, high;
  std::uint32_t triangle;
  std::uint8_t corner;
  bool backwards;

  bool joins(const WindingEdge& b) const { return low == b.low && high == b.high; }
  bool operator<(const WindingEdge& b) const {
    return std::tie(low, high, triangle, corner) < std::tie(b.low, b.high, b.triangle, b.corner);
  }
};

bool is_closed(const std::vector<WindingTriangle>& triangles) {
  std::atomic<std::uint64_t> sum = 0;
  in_parts(triangles.size(), 1u << 13, [&](std::size_t begin, std::size_t end) {
    std::uint64_t part = 0;
    for (std::size_t t = begin; t < end; ++t) {
      std::uint64_t number[3];
      for (int k = 0; k < 3; ++k) number[k] = place_number(triangles[t].corner[k]);
      for (int k = 0; k < 3; ++k) part += edge_number(number[k], number[(k + 1) % 3]);
    }
    sum += part;
  });
  return sum == 0;
}

/// Sets the caps of surfaces. False if there were too many.
bool set_caps(const std::vector<WindingTriangle>& triangles, std::vector<WindingTriangle>& caps) {
  if (is_closed(triangles)) return true;
  std::vector<WindingEdge> edges(3 * triangles.size());
  in_parts(triangles.size(), 1u << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      for (std::uint8_t k = 0; k < 3; ++k) {
        const std::uint64_t a = place_number(triangles[t].corner[k]);
        const std::uint64_t b = place_number(triangles[t].corner[(k + 1) % 3]);
        edges[3 * t + k] = {std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(t), k, a > b};
      }
  });
  tbb::parallel_sort(edges.begin(), edges.end());
  std::optional<Vec3f> tip;
  for (std::size_t begin = 0, end; begin < edges.size(); begin = end) {
    int balance = 0;
    for (end = begin; end < edges.size() && edges[end].joins(edges[begin]); ++end)
      balance += edges[end].backwards ? -1 : 1;
    if (balance == 0) continue;
    const WindingEdge& e = edges[begin];
    const WindingTriangle& t = triangles[e.triangle];
    Vec3f from = t.corner[e.corner], to = t.corner[(e.corner + 1) % 3];
    if (e.backwards != (balance < 0)) std::swap(from, to);
    if (!tip) tip = from;
    if (*tip == from || *tip == to) continue;
    if (caps.size() + static_cast<std::size_t>(std::abs(balance)) > kMostCaps) return false;
    caps.insert(caps.end(), static_cast<std::size_t>(std::abs(balance)), {{*tip, from, to}});
  }
  return true;
}

/// The part of the winding number of caps beyond whole turns, and a bound on its error: the directions of all
/// (x, y), multiplied.
WindingSum turns_of_caps(const std::vector<WindingTriangle>& caps, const Vec3d& p) {
  constexpr double off = 0x1p-47;
  WindingSum sum;
  double re = 1, im = 0;
  for (const WindingTriangle& cap : caps) {
    const Vec3d a = Vec3d(cap.corner[0]) - p, b = Vec3d(cap.corner[1]) - p, c = Vec3d(cap.corner[2]) - p;
    const double la = length(a), lb = length(b), lc = length(c), size = la * lb * lc;
    const double x = 1 + (dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb) / size;
    const double y = dot(a, cross(b, c)) / size, far = std::sqrt(x * x + y * y);
    if (!(far > off) || !(size > 1e-200)) return {0, 1};
    const double turned = (re * x - im * y) / far;
    im = (re * y + im * x) / far, re = turned;
    sum.error += off * (1 + 0.25 / far);
  }
  sum.value = portable::atan2(im, re) / (2 * std::numbers::pi);
  sum.error += 0x1p-39;
  return sum;
}

}  // namespace

WindingField::WindingField(const Accel& accel) {
  for (const std::uint8_t kind : accel.kinds)
    shows_others |= static_cast<Kind>(kind) != Kind::triangle && !holds_instances(static_cast<Kind>(kind));
  std::vector<WindingTriangle> triangles;
  triangles.reserve(accel.stats.triangles);
  each_triangle(accel, [&](const WindingTriangle& t) { triangles.push_back(t); });
  meshes = make_winding_tree(std::span<const WindingTriangle>(triangles));
  is_capped = set_caps(triangles, caps);
  triangles = {};
  std::vector<WindingMoments> moments;
  each_part(accel, [&](const WindingPart& part) {
    const WindingField& child = winding_field(*part.child);
    shows_others |= child.shows_others;
    if (child.empty()) return;
    is_capped &= child.is_capped && child.caps.empty();
    parts.push_back(part);
    moments.push_back(child.whole.moved(part.to_outer, std::abs(part.to_outer.uniform_scale())));
  });
  shown = make_winding_tree(std::span<const WindingMoments>(moments));
  if (empty()) return;
  whole.center = meshes.empty() ? shown.whole.center : meshes.whole.center;
  if (!meshes.empty()) whole.add(meshes.whole.about(whole.center));
  if (!shown.empty()) whole.add(shown.whole.about(whole.center));
}

const WindingField& winding_field(const Accel& accel) {
  // A thread that waits in here takes no other task: that could ask for the same field.
  PointAnswers& answers = *accel.answers;
  std::call_once(answers.winding_once, [&] {
    tbb::this_task_arena::isolate([&] { answers.winding = std::make_unique<const WindingField>(accel); });
  });
  return *answers.winding;
}

// ---- Sums over trees.

namespace {

/// Coordinates up to which floats serve, in the unit of a tree.
constexpr double kMostFloat = 0x1p30;

double frobenius(const Affine& m) {
  double sum = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += m.m[i][j] * m.m[i][j];
  return std::sqrt(sum);
}

/// The linear part of a map. Winding numbers do not depend on scale, so it is brought to a size of one.
WindingMap winding_map(const Affine& map) {
  const double size = frobenius(map);
  const Affine m = Affine::scaling({1 / size, 1 / size, 1 / size}) * map, inverse = m.inverse();
  const double det = m.determinant();
  WindingMap r{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      r.linear[i][j] = m.m[i][j], r.cofactor[i][j] = std::abs(det) * inverse.m[j][i];
  r.stretch = frobenius(m) * (1 + 0x1p-20);
  r.turned = std::abs(det) * frobenius(inverse) * (1 + 0x1p-20);
  r.side = det < 0 ? -1 : 1;
  r.unit = 0x1p-53 * (1 + 4 * frobenius(m) * frobenius(inverse));
  return r;
}

/// Sums up what a structure shows for one point.
class FieldSum {
 public:
  /// What has a remainder of at most `limit` is seen as a whole; in double if `precise`.
  FieldSum(const PointCode& code, double limit, bool precise)
      : code_(code), limit_(limit), precise_(precise) {}

  WindingSum of(const Accel& accel, const Vec3f& point) {
    add(winding_field(accel), Vec3d(point), nullptr, !precise_);
    return sum_;
  }

 private:
  /// `to_world`: null where the structure stands undistorted.
  void add(const WindingField& field, const Vec3d& point, const Affine* to_world, bool is_float) {
    if (!field.meshes.empty()) add_tree(field.meshes, point, to_world, is_float, nullptr);
    if (field.shown.empty()) return;
    OpenParts open;
    add_tree(field.shown, point, to_world, false, &open);
    for (const std::uint32_t number : open.list) {
      const WindingPart& part = field.parts[number];
      const Affine world = to_world != nullptr ? *to_world * part.to_outer : part.to_outer;
      const bool is_similar = to_world == nullptr && world.uniform_scale() != 0;
      add(winding_field(*part.child), part.to_child.point(point), is_similar ? nullptr : &world, false);
    }
  }

  void add_tree(const WindingTree& tree, const Vec3d& point, const Affine* to_world, bool is_float,
                OpenParts* open) {
    const Vec3d p = point * tree.scale;
    WindingSum sum;
    if (to_world != nullptr) {
      const WindingMap map = winding_map(*to_world);
      sum = code_.winding_mapped(tree, p, limit_, map, open);
    } else if (is_float && max_component(abs(p)) < kMostFloat) {
      sum = code_.winding(tree, Vec3f(p), static_cast<float>(limit_));
    } else {
      sum = code_.winding_precise(tree, p, limit_, open);
    }
    sum_.value += sum.value, sum_.error += sum.error;
  }

  const PointCode& code_;
  const double limit_;
  const bool precise_;
  WindingSum sum_;
};

// ---- Solid angles in extended precision, of all triangles.

using Vec3l = Vec3<long double>;

Vec3l mapped_long(const Affine& m, const Vec3l& p) {
  const auto row = [&](std::size_t i) {
    return static_cast<long double>(m.m[i][0]) * p.x + static_cast<long double>(m.m[i][1]) * p.y +
           static_cast<long double>(m.m[i][2]) * p.z + static_cast<long double>(m.m[i][3]);
  };
  return {row(0), row(1), row(2)};
}

class ExactSum {
 public:
  explicit ExactSum(const Vec3f& point) : p_(Vec3l(point)) {}

  void add(const Accel& accel, const std::vector<const Affine*>& chain) {
    bool mirrored = false;
    for (const Affine* m : chain) mirrored ^= m->determinant() < 0;
    each_triangle(accel, [&](const WindingTriangle& t) {
      Vec3l v[3];
      for (int k = 0; k < 3; ++k) {
        v[k] = Vec3l(t.corner[k]);
        for (std::size_t i = chain.size(); i-- > 0;) v[k] = mapped_long(*chain[i], v[k]);
        v[k] = v[k] - p_;
      }
      add_triangle(v[0], mirrored ? v[2] : v[1], mirrored ? v[1] : v[2]);
    });
    each_part(accel, [&](const WindingPart& part) {
      std::vector<const Affine*> longer = chain;
      longer.push_back(&part.to_outer);
      add(*part.child, longer);
    });
  }
  long double turns() const { return turns_; }
  long double error() const { return error_; }

 private:
  void add_triangle(const Vec3l& a, const Vec3l& b, const Vec3l& c) {
    constexpr long double off = 64 * std::numeric_limits<long double>::epsilon();
    const long double la = length(a), lb = length(b), lc = length(c), size = la * lb * lc;
    const long double y = dot(a, cross(b, c));
    const long double x = size + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    // A point on the triangle sees half of all directions on either side of it, which cancel.
    if (x <= off * size && std::abs(y) <= off * size) return;
    turns_ += std::atan2(y, x) / (2 * std::numbers::pi_v<long double>);
    error_ += off * (1 + size / std::max(std::abs(x), std::abs(y)));
  }

  Vec3l p_;
  long double turns_ = 0, error_ = 0;
};

ExactSum exact_sum(const Accel& accel, const Vec3f& point) {
  ExactSum sum(point);
  sum.add(accel, {});
  return sum;
}

}  // namespace

/// What a sum and the caps tell together: off by at most `error`, which is 1 if they tell nothing.
static WindingSum capped(const WindingField& field, const Vec3f& point, const WindingSum& sum) {
  if (!field.is_capped || !(sum.error < 0.5)) return {0, 1};
  WindingSum turns = field.caps.empty() ? WindingSum{} : turns_of_caps(field.caps, Vec3d(point));
  if (!(sum.error + turns.error < 0.5)) return {0, 1};
  turns.value += std::round(sum.value - turns.value);
  return turns;
}

/// First tries, with a limit of what is left out of each node.
struct WindingTry {
  double limit;
  bool precise;
};

double winding_within(const Accel& accel, const Vec3f& point, double error, const PointCode& code) {
  const WindingField& field = winding_field(accel);
  if (field.is_capped)
    for (const WindingTry& t :
         {WindingTry{0x1p-6, false}, WindingTry{0x1p-9, false}, WindingTry{0x1p-14, true}}) {
      const WindingSum sum = FieldSum(code, t.limit, t.precise).of(accel, point);
      if (sum.error <= error) return sum.value;
      const WindingSum turns = capped(field, point, sum);
      if (turns.error <= error) return turns.value;
      // A face that the point is on, or nearly so, stays in doubt.
      if (t.precise && sum.error >= 0.5) return static_cast<double>(exact_sum(accel, point).turns());
    }
  // Roundings of float alone come to about this.
  const bool precise = error < 0x1p-14;
  double limit = error / 16;
  for (int i = 0; i < 6 && limit > 0x1p-40; ++i) {
    const WindingSum sum = FieldSum(code, limit, precise || i > 1).of(accel, point);
    if (sum.error <= error) return sum.value;
    limit /= 8;
  }
  return static_cast<double>(exact_sum(accel, point).turns());
}

bool winds_around(const Accel& accel, const Vec3f& point, const PointCode& code) {
  const WindingField& field = winding_field(accel);
  constexpr WindingTry kTries[] = {
      {0x1p-6, false}, {0x1p-9, false}, {0x1p-14, true}, {0x1p-22, true}, {0x1p-30, true}};
  const auto tells = [](const WindingSum& sum) { return std::abs(std::abs(sum.value) - 0.5) > sum.error; };
  for (const WindingTry& t : kTries) {
    WindingSum sum = FieldSum(code, t.limit, t.precise).of(accel, point);
    if (t.precise && sum.error >= 0.5) break;
    if (!tells(sum)) {
      sum = capped(field, point, sum);
      // What is 1/2 but for roundings no tree tells apart.
      if (sum.error < 0x1p-30 && !tells(sum)) break;
    }
    if (tells(sum)) return std::abs(sum.value) > 0.5;
  }
  const ExactSum sum = exact_sum(accel, point);
  return std::abs(sum.turns()) - 0.5L > sum.error();
}

}  // namespace oktett
