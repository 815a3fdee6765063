#pragma once
/// \file Solid boxes, axis-aligned or oriented: the slab method of Kay and Kajiya 1986 in the space where the
/// box is a cube (Zachmann 2010: the interval of a ray inside a box).

#include <algorithm>
#include <cmath>

#include "core/transform.h"
#include "kernels/closed/closest_triangle.h"
#include "kernels/closed/contract.h"

namespace oktett {

/// Numbers of a primitive: the rows of the 3x4 map from the world to the cube [-1, 1]^3, and of its inverse.
struct BoxSolid : NumberedShape<BoxSolid, 24> {
  static constexpr int kRoots = 2;
  using Data = BoxShape;
  static constexpr bool kNeedsSimilarity = false;

  template <class D>
  struct Lanes {
    D m[12];  ///< to the cube
  };
  template <class D, class Number>
  OKTETT_INLINE static Lanes<D> lanes(const Number& number) {
    Lanes<D> l;
    for (int k = 0; k < 12; ++k) l.m[k] = number(k);
    return l;
  }

  static bool is_empty(const BoxShape& s) {
    return !(s.min.x < s.max.x && s.min.y < s.max.y && s.min.z < s.max.z);
  }
  /// `to_world` maps the shape's own space to the world and must be invertible.
  static void add(Pool& p, const BoxShape& s, const Affine& to_world, std::uint32_t item) {
    const Affine cube =
        to_world * Affine::translation((s.min + s.max) * 0.5) * Affine::scaling((s.max - s.min) * 0.5);
    const Affine inverse = cube.inverse();
    std::array<double, 24> numbers;
    for (int k = 0; k < 12; ++k) numbers[k] = inverse.m[k / 4][k % 4], numbers[12 + k] = cube.m[k / 4][k % 4];
    p.add(numbers, item);
  }

  /// A ray exactly parallel to a slab is inside it throughout or never; a ray in a face counts as inside.
  template <class D>
  OKTETT_INLINE static typename D::M roots(const RayLanes<D>& ray, const Lanes<D>& s, D (&t)[2]) {
    const D one(1.0), zero(0.0);
    D near(-std::numeric_limits<double>::infinity()), far(std::numeric_limits<double>::infinity());
    auto meets = zero == zero;
    for (int k = 0; k < 3; ++k) {
      const D* r = &s.m[4 * k];
      const D o = ((r[0] * ray.o.x + r[1] * ray.o.y) + r[2] * ray.o.z) + r[3];
      const D d = (r[0] * ray.d.x + r[1] * ray.d.y) + r[2] * ray.d.z;
      const D a = (-one - o) / d, b = (one - o) / d;
      const auto parallel = d == zero;
      near = select(parallel, near, max(min(a, b), near));
      far = select(parallel, far, min(max(a, b), far));
      meets = meets & (~parallel | (abs(o) <= one)) & (d == d) & (o == o);
    }
    t[0] = near, t[1] = far;
    return meets & (near <= far);
  }

  static Affine to_cube(const Pool& p, std::size_t i) { return map_of(p.number, i); }
  static Affine to_world(const Pool& p, std::size_t i) { return map_of(p.number + 12, i); }

  static Box bounds(const Pool& p, std::size_t i) {
    const Affine world = to_world(p, i);
    Vec3d middle, half, reach;
    for (int k = 0; k < 3; ++k) {
      middle[k] = world.m[k][3];
      half[k] = std::abs(world.m[k][0]) + std::abs(world.m[k][1]) + std::abs(world.m[k][2]);
      reach[k] = std::abs(middle[k]) + half[k];
    }
    half += displacement(to_cube(p, i), world, reach);
    return {round_down(middle - half), round_up(middle + half)};
  }

  static bool inside(const Pool& p, std::size_t i, const Vec3d& q) {
    return max_component(abs(to_cube(p, i).point(q))) < 1;
  }

  /// The nearest point of the faces, also for points inside. The map may shear the box.
  static SurfaceNearest closest(const BoxShape& s, const Affine& to_world, const Vec3d& p) {
    const Vec3d size = (s.max - s.min) * 0.5;
    Vec3d half[3];
    for (int k = 0; k < 3; ++k)
      half[k] = Vec3d{to_world.m[0][k], to_world.m[1][k], to_world.m[2][k]} * size[k];
    for (int k = 0; k < 3; ++k) {
      const Vec3d &a = half[k], &b = half[(k + 1) % 3];
      if (!(std::abs(dot(a, b)) <= 1e-14 * length(a) * length(b))) return closest_on_sheared(s, to_world, p);
    }
    return closest_on_straight(to_world.point((s.min + s.max) * 0.5), half, p);
  }

  template <class D, class Fetch>
  OKTETT_INLINE static SurfacePoints<D> surface(const Pool& p, const Fetch& fetch, const HitPoints<D>& hit) {
    AffineLanes<D> to_cube, to_world;
    for (int k = 0; k < 12; ++k) {
      to_cube.m[k / 4][k % 4] = fetch(p.number[k]);
      to_world.m[k / 4][k % 4] = fetch(p.number[12 + k]);
    }
    const Vec3<D> world = hit.point(), q = map_point(to_cube, world), m{abs(q.x), abs(q.y), abs(q.z)};
    // The face met is the nearest one; the lowest axis wins ties.
    const auto x = (m.x >= m.y) & (m.x >= m.z), y = ~x & (m.y >= m.z), z = ~(x | y);
    const D zero(0.0), one(1.0);
    const auto side = [](const D& v) { return select(v < D(0.0), D(-1.0), D(1.0)); };
    const Vec3<D> face{select(x, side(q.x), zero), select(y, side(q.y), zero), select(z, side(q.z), zero)};
    // Onto the face along the normal that it has in the world: an axis of the cube is not upright on it under
    // a flat map.
    const Vec3<D> n = map_normal(to_cube, face);
    const Vec3<D> point = sub_lanes(world, scale_lanes(n, (dot_lanes(face, q) - one) / dot_lanes(n, n)));
    const D extent = length_lanes(map_vector(to_world, Vec3<D>{one, one, one}));
    return {point, D(0x1p-46) * (length_lanes(point) + extent), unit_lanes(n)};
  }

  /// uv: position on the face, [0, 1]^2.
  static void uv(const Pool& p, std::size_t i, const Vec3d& hit, const Vec3d&, SurfaceInteraction& s) {
    const Affine cube = to_cube(p, i);
    const Vec3d q = cube.point(hit);
    const int k = dominant_axis(q), a = (k + 1) % 3, b = (k + 2) % 3;
    s.uv = {static_cast<float>(0.5 + 0.5 * q[a]), static_cast<float>(0.5 + 0.5 * q[b])};
    Vec3d tangent{0, 0, 0}, bitangent{0, 0, 0};
    tangent[a] = 2, bitangent[b] = 2;
    const Affine world = to_world(p, i);
    s.tangent = Vec3f(world.vector(tangent)), s.bitangent = Vec3f(world.vector(bitangent));
  }

 private:
  /// A box whose axes stay perpendicular: `half` are the vectors from the centre to three faces.
  static SurfaceNearest closest_on_straight(const Vec3d& center, const Vec3d (&half)[3], const Vec3d& p) {
    double at[3], size[3], excess[3];
    int axis = 0;
    for (int k = 0; k < 3; ++k) {
      size[k] = length(half[k]);
      at[k] = dot(p - center, half[k] / size[k]);
      excess[k] = std::abs(at[k]) - size[k];
      if (excess[k] > excess[axis]) axis = k;
    }
    const double side = at[axis] < 0 ? -1 : 1;
    const Vec3d normal = half[axis] * (side / size[axis]);
    // From inside only the nearest face counts.
    if (excess[axis] <= 0) return {excess[axis] * excess[axis], p - normal * excess[axis], normal};
    Vec3d point = center;
    double d2 = 0;
    for (int k = 0; k < 3; ++k) {
      point += half[k] * (std::clamp(at[k], -size[k], size[k]) / size[k]);
      if (excess[k] > 0) d2 += excess[k] * excess[k];
    }
    return {d2, point, normal};
  }

  /// A sheared box: each face is two triangles.
  static SurfaceNearest closest_on_sheared(const BoxShape& box, const Affine& m, const Vec3d& p) {
    using D = Simd<double, 1, ScalarIsa>;
    SurfaceNearest best;
    const Vec3d center = m.point((box.min + box.max) * 0.5);
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2, i = (axis + 1) % 3, j = (axis + 2) % 3;
      const auto corner = [&](bool high_i, bool high_j) {
        Vec3d q = box.min;
        if (face % 2 == 1) q[axis] = box.max[axis];
        if (high_i) q[i] = box.max[i];
        if (high_j) q[j] = box.max[j];
        return m.point(q);
      };
      const Vec3d a = corner(false, false), c = corner(true, true);
      Vec3d n = normalize(cross(corner(true, false) - a, corner(false, true) - a));
      if (dot(n, a - center) < 0) n = -n;
      for (const Vec3d& b : {corner(true, false), corner(false, true)}) {
        const auto near = closest_on_triangle(oktett::broadcast<D>(p), oktett::broadcast<D>(a),
                                              oktett::broadcast<D>(b), oktett::broadcast<D>(c));
        const double u = only_lane(near.u), v = only_lane(near.v);
        best.keep_nearer(p, {only_lane(near.d2), a + (b - a) * u + (c - a) * v, n});
      }
    }
    return best;
  }

  static Affine map_of(const Column<double>* columns, std::size_t i) {
    Affine a;
    for (int k = 0; k < 12; ++k) a.m[k / 4][k % 4] = columns[k][i];
    return a;
  }
};

}  // namespace oktett
