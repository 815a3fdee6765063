#include "accel/closest.h"

#include <algorithm>
#include <cmath>

#include "accel/hit_place.h"
#include "accel/instance.h"
#include "core/rounding.h"
#include "kernels/closed/closest_triangle.h"
#include "kernels/exact_ops.h"

namespace oktett {
namespace {

/// Decisions in double are off by at most a few of these times the coordinates.
constexpr double kRounding = 0x1p-44;

double norm1(const Vec3d& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

/// The greatest coordinates of what has bounds.
Vec3d reach_of(const Accel& accel) {
  if (accel.bounds.empty()) return {0, 0, 0};
  return Vec3d(max(abs(accel.bounds.lo), abs(accel.bounds.hi)));
}

using Linear = std::array<std::array<double, 3>, 3>;

Linear linear_of(const Affine& m) {
  Linear l;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) l[i][j] = m.m[i][j];
  return l;
}

Linear transposed(const Linear& a) {
  Linear t;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) t[i][j] = a[j][i];
  return t;
}

Linear product(const Linear& a, const Linear& b) {
  Linear c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  return c;
}

/// The greatest sum of magnitudes in a row, which bounds the magnitudes of the eigenvalues.
double row_norm(const Linear& a) {
  double greatest = 0;
  for (const auto& row : a)
    greatest = std::max(greatest, std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]));
  return greatest;
}

/// A bound on how much the map that `m` inverts only roughly may lengthen a vector: with E = 1 - B M, which
/// is small, |x| <= |B M x| + |E| |x|, so |x| <= |B| / (1 - |E|) |M x|. The greatest singular value of B is
/// bounded by the row norms of B B^T and B^T B, which for rotated scales are its square.
double stretch_of_inverse(const Affine& map, const Affine& inverse) {
  const Linear m = linear_of(map), b = linear_of(inverse), bt = transposed(b);
  Linear error = product(b, m);
  for (int k = 0; k < 3; ++k) error[k][k] -= 1;
  const double off =
      2 * (row_norm(error) + row_norm(transposed(error))) + 0x1p-48 * row_norm(b) * row_norm(m);
  if (!(off < 0.5)) return std::numeric_limits<double>::infinity();
  return std::sqrt(std::min(row_norm(product(b, bt)), row_norm(product(bt, b)))) / (1 - off) * (1 + 0x1p-40);
}

/// Where shape `k` of a pool or leaf stands, seen from `place`, and its nearest point to the place's point.
class ShapeAt {
 public:
  ShapeAt(const Accel& accel, const Affine* to_world, const Vec3d& p)
      : accel_(accel), to_world_(to_world), p_(p) {}

  /// Element `k` of the pool of a kind.
  SurfaceNearest operator()(Kind kind, std::uint32_t k) const {
    if (is_exact(kind)) {
      const ExactPoolBase& pool = accel_.exact_pool(kind);
      return exact_ops(kind).closest(pool, k, moved(pool.frames[k].to_world), p_);
    }
    SurfaceNearest nearest;
    visit_pool(kind, accel_.pools, [&]<class S>(S, const typename S::Pool& pool) {
      if constexpr (requires { S::shape(pool, k); })
        nearest = S::closest(S::shape(pool, k), to_world_ != nullptr ? *to_world_ : Affine{}, p_);
      else
        nearest = of_geometry<S>(pool.item[k]);
    });
    return nearest;
  }

 private:
  Affine moved(const Affine& m) const { return to_world_ != nullptr ? *to_world_ * m : m; }

  template <class S>
  SurfaceNearest of_geometry(std::uint32_t item) const {
    const std::uint32_t number = accel_.geometry_of(item);
    const Geometry& g = accel_.geometries[number];
    const auto& data = std::get<typename S::Data>(g.shape);
    return S::closest(nth_shape<S>(data, item - accel_.first_item[number]), moved(g.transform), p_);
  }

  const Accel& accel_;
  const Affine* to_world_;
  const Vec3d& p_;
};

void set_triangle(const HitPlace& place, const HitNames& names, const Vec3d& p, ClosestPoint& out) {
  using D = Simd<double, 1, ScalarIsa>;
  const Geometry& g = place.accel->geometries[names.geometry];
  const TriangleMesh& mesh = *std::get<MeshGeometry>(g.shape).mesh;
  const GeometryFrame& frame = place.accel->frames[names.geometry];
  Vec3d v[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f& corner = mesh.positions[mesh.indices[3 * std::size_t{names.primitive} + k]];
    // Triangles are traced with their corners rounded to float where the geometry puts them.
    v[k] = frame.identity ? Vec3d(corner) : rounded_to_floats(g.transform.point(Vec3d(corner)));
    if (place.moved) v[k] = place.to_world.point(v[k]);
  }
  const auto nearest =
      closest_on_triangle(broadcast<D>(p), broadcast<D>(v[0]), broadcast<D>(v[1]), broadcast<D>(v[2]));
  const double u = only_lane(nearest.u), w = only_lane(nearest.v);
  const Vec3d point = v[0] + ((v[1] - v[0]) * u + (v[2] - v[0]) * w);
  out.point = Vec3f(point);
  out.u = static_cast<float>(u), out.v = static_cast<float>(w);
  Vec3d n = cross(v[1] - v[0], v[2] - v[0]);
  const bool mirrored = frame.mirrored != (place.moved && place.to_world.determinant() < 0);
  if (mirrored) n = -n;
  // A triangle without area has the direction to the point, if there is one.
  if (!(length(n) > 0)) n = p - point;
  out.normal = Vec3f(length(n) > 0 ? normalize(n) : Vec3d{0, 0, 1});
}

/// The first shape of `accel` itself that does not answer, in words.
std::string missing_here(const Accel& accel, bool distorted) {
  if (!accel.combinations.empty()) return "a Boolean combination";
  const auto distorts = [](const std::string& name) { return "a " + name + " that its transform distorts"; };
  std::string missing;
  each_closed_form([&]<class S>(S, Kind kind) {
    if (distorted && S::kNeedsSimilarity && std::get<typename S::Pool>(accel.pools).size() > 0 &&
        missing.empty())
      missing = distorts(name_of(kind));
  });
  if (!missing.empty()) return missing;
  for (int k = 0; k < kKinds; ++k) {
    if (accel.exact[k] == nullptr || accel.exact[k]->frames.empty()) continue;
    const ExactOps& ops = exact_ops(static_cast<Kind>(k));
    if (ops.closest == nullptr) return std::string("a surface of kind '") + ops.name + "'";
    const auto& frames = accel.exact[k]->frames;
    const bool kept = std::all_of(frames.begin(), frames.end(),
                                  [&](const ExactFrame& f) { return ops.is_kept_by(f.to_world); });
    if (distorted || !kept) return distorts(ops.name);
  }
  return {};
}

}  // namespace

void note_missing_closest(Accel& accel) {
  for (int distorted = 0; distorted < 2; ++distorted) {
    std::string& missing = accel.no_closest_point[distorted];
    missing = missing_here(accel, distorted == 1);
    const auto add = [&](const auto& instance, const Accel& child) {
      if (!missing.empty() || (child.no_closest_point[0].empty() && child.no_closest_point[1].empty()))
        return;
      const bool distorts = distorted == 1 || Affine::from_rows(instance.to_child).uniform_scale() == 0;
      missing = child.no_closest_point[distorts];
    };
    for (const InstanceItem& i : accel.instances) add(i, *i.child);
    for (const ListedInstance& i : accel.listed_instances) add(i, *accel.listed_children[i.child]);
  }
}

PointPlace place_point(const Accel& accel, const Vec3f& point) {
  PointPlace place;
  place.world = Vec3d(point);
  place.lo = place.hi = point;
  place.slack = kRounding * (norm1(place.world) + norm1(reach_of(accel)));
  return place;
}

Nearest nearest_by(const PointPlace& place, const Vec3d& other, const Nearest& of_other) {
  // A little more, so that the surface itself is nearer than this, however it is rounded.
  const double reach =
      (std::sqrt(of_other.d2) + length(place.world - other)) * (1 + 0x1p-40) + 4 * place.slack;
  return {reach * reach};
}

PointPlace place_in_instance(const PointPlace& outer, const Accel& accel, std::uint32_t number) {
  PointPlace place;
  place.world = outer.world, place.moved = true;
  with_instance(accel, number, [&](const auto& instance, const Accel& child) {
    const Affine to_child = Affine::from_rows(instance.to_child);
    Affine to_outer;
    if (number < kListedNumber)
      to_outer = accel.geometries[accel.geometry_of(instance.item)].transform;
    else
      to_outer = to_child.inverse();
    place.to_world = outer.moved ? outer.to_world * to_outer : to_outer;
    place.to_here = outer.moved ? to_child * outer.to_here : to_child;
    place.instance = outer.instance + (outer_path(instance, kNoId) + 1);
    const Affine& m = place.to_world;
    const Vec3d here = place.to_here.point(place.world), reach = max(abs(here), reach_of(child));
    place.lo = round_down(here), place.hi = round_up(here);
    place.scale = stretch_of_inverse(m, place.to_here);
    // The point may come back from this space a little off.
    double size = norm1(place.world);
    for (const auto& row : m.m)
      size += std::abs(row[0]) * reach.x + std::abs(row[1]) * reach.y + std::abs(row[2]) * reach.z +
              std::abs(row[3]);
    place.slack = norm1(m.point(here) - place.world) + kRounding * size;
  });
  return place;
}

void closest_in_leaf(const Accel& accel, const LeafEntry& leaf, const PointPlace& place, Nearest& best) {
  const ShapeAt nearest(accel, place.moved ? &place.to_world : nullptr, place.world);
  for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k) {
    const std::uint32_t element = is_exact(leaf.kind) ? accel.exact_pool(leaf.kind).cells[k].element : k;
    best.keep(nearest(leaf.kind, element).d2, accel.item_in_pool(leaf.kind, element), place.instance);
  }
}

ClosestPoint closest_surface(const Accel& accel, const Vec3f& point, const Nearest& nearest) {
  ClosestPoint out;
  if (nearest.item == kNoId) return out;
  out.distance = distance_of(nearest);
  out.item = nearest.item, out.instance = nearest.instance;
  const HitPlace place = follow_path(accel, nearest.instance);
  const HitNames names = identify_in(place, out.hit());
  const Vec3d p(point);
  if (names.kind == Kind::triangle) {
    set_triangle(place, names, p, out);
    return out;
  }
  const Accel& a = *place.accel;
  const ShapeAt at(a, place.moved ? &place.to_world : nullptr, p);
  const SurfaceNearest s = at(names.kind, a.index_in_pool(names.geometry, names.primitive));
  out.point = Vec3f(s.point), out.normal = Vec3f(s.normal);
  return out;
}

}  // namespace oktett
