#pragma once
/// \file Planar simple polygons: ray against plane, then point in polygon in the dominant coordinate plane.

#include <algorithm>
#include <vector>

#include "kernels/closed/closest_triangle.h"
#include "kernels/closed/plane.h"

namespace oktett {

struct Polygon {
  static constexpr int kRoots = 1;
  using Data = PolygonShape;
  static constexpr bool kNeedsSimilarity = false;

  struct Pool {
    Column<double> nx, ny, nz, offset;         ///< plane with unit normal
    Column<std::uint32_t> axis, begin, count;  ///< dropped axis; range of projected edges
    Column<double> u[2], v[2];                 ///< lower and upper ends of the edges of all polygons
    Column<std::uint32_t> item;
    std::vector<Box> boxes;
    std::size_t size() const { return item.size(); }
    std::size_t bytes() const {
      return nx.bytes() * 4 + axis.bytes() * 4 + u[0].bytes() * 4 + boxes.size() * sizeof(Box);
    }
  };

  /// Polygons differ in their number of vertices, so rays in lanes are tested against one polygon at a time.
  template <class D>
  struct Lanes {
    Vec3<D> n;
    D offset;
    const double *u[2], *v[2];
    std::uint32_t axis, count;
  };

  /// Newell's normal: twice the polygon's area along the direction from which it runs counter-clockwise.
  static Vec3d area_normal(const std::vector<Vec3d>& p) {
    Vec3d n{0, 0, 0};
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Vec3d a = p[i] - p[0], b = p[(i + 1) % p.size()] - p[0];
      n += cross(a, b);
    }
    return n;
  }

  /// Calls f(a, b) for each edge, of the holes, too.
  template <class F>
  static void each_edge(const PolygonShape& s, F&& f) {
    const auto ring = [&](const std::vector<Vec3d>& points) {
      for (std::size_t i = 0, j = points.size() - 1; i < points.size(); j = i++) f(points[j], points[i]);
    };
    ring(s.vertices);
    for (const PolygonHole& hole : s.holes) ring(hole.vertices);
  }
  static bool is_empty(const PolygonShape& s) {
    return s.vertices.size() < 3 || !(length(area_normal(s.vertices)) > 0);
  }
  /// A mirror reverses the order of the vertices, but the front stays the front.
  static PolygonShape moved(PolygonShape s, const Affine& m) {
    for (Vec3d& v : s.vertices) v = m.point(v);
    for (PolygonHole& hole : s.holes)
      for (Vec3d& v : hole.vertices) v = m.point(v);
    if (m.determinant() < 0) std::reverse(s.vertices.begin(), s.vertices.end());
    return s;
  }
  static void add(Pool& p, const PolygonShape& s, const Affine& to_world, std::uint32_t item) {
    add(p, moved(s, to_world), item);
  }
  static void add(Pool& p, const PolygonShape& s, std::uint32_t item) {
    const Vec3d n = normalize(area_normal(s.vertices));
    Vec3d centroid{0, 0, 0};
    for (const Vec3d& q : s.vertices) centroid += q / static_cast<double>(s.vertices.size());
    p.nx.push_back(n.x), p.ny.push_back(n.y), p.nz.push_back(n.z);
    p.offset.push_back(dot(n, centroid));
    const int axis = dominant_axis(n);
    p.axis.push_back(static_cast<std::uint32_t>(axis));
    p.begin.push_back(static_cast<std::uint32_t>(p.u[0].size()));
    p.item.push_back(item);
    Box box;
    std::uint32_t count = 0;
    each_edge(s, [&](const Vec3d& a, const Vec3d& b) {
      // An edge is always evaluated from its lower to its upper end, so that neighbours which share it agree
      // to the last bit.
      const bool upward = a[(axis + 2) % 3] < b[(axis + 2) % 3];
      for (int end = 0; end < 2; ++end) {
        const Vec3d& q = upward == (end == 1) ? b : a;
        p.u[end].push_back(q[(axis + 1) % 3]), p.v[end].push_back(q[(axis + 2) % 3]);
      }
      ++count;
    });
    p.count.push_back(count);
    for (const Vec3d& q : s.vertices) {
      // Rounding may move vertices off the common plane, on which the hits lie.
      const Vec3d pad = Vec3d{1, 1, 1} * (std::abs(dot(n, q - centroid)) + 0x1p-45 * max_component(abs(q)));
      box.grow(round_down(q - pad)), box.grow(round_up(q + pad));
    }
    p.boxes.push_back(box);
  }
  static void finish(Pool&) {}

  template <class D>
  OKTETT_INLINE static Lanes<D> broadcast(const Pool& p, std::size_t i) {
    return {{D(p.nx[i]), D(p.ny[i]), D(p.nz[i])},
            D(p.offset[i]),
            {&p.u[0][p.begin[i]], &p.u[1][p.begin[i]]},
            {&p.v[0][p.begin[i]], &p.v[1][p.begin[i]]},
            p.axis[i],
            p.count[i]};
  }
  template <class D>
  OKTETT_INLINE static Lanes<D> load(const Pool& p, std::size_t i) {
    static_assert(D::kWidth == 1);
    return broadcast<D>(p, i);
  }

  /// Crossing number with half-open edges, so that polygons that share an edge share no point of it.
  template <class D>
  OKTETT_INLINE static typename D::M roots(const RayLanes<D>& ray, const Lanes<D>& s, D (&t)[1]) {
    const auto meets = plane_root(ray, s.n, s.offset, t[0]);
    const Vec3<D> p{ray.o.x + t[0] * ray.d.x, ray.o.y + t[0] * ray.d.y, ray.o.z + t[0] * ray.d.z};
    const D pu = s.axis == 0 ? p.y : s.axis == 1 ? p.z : p.x;
    const D pv = s.axis == 0 ? p.z : s.axis == 1 ? p.x : p.y;
    auto inside = meets & ~meets;
    for (std::uint32_t i = 0; i < s.count; ++i) {
      const D u0(s.u[0][i]), v0(s.v[0][i]), u1(s.u[1][i]), v1(s.v[1][i]);
      const auto straddles = ~(v0 > pv) & (v1 > pv);
      const auto left = pu < u0 + (pv - v0) / (v1 - v0) * (u1 - u0);
      const auto crossing = straddles & left;
      inside = (inside & ~crossing) | (~inside & crossing);
    }
    return meets & inside;
  }

  static Box bounds(const Pool& p, std::size_t i) { return p.boxes[i]; }

  static SurfaceNearest closest(const PolygonShape& s, const Affine& to_world, const Vec3d& p) {
    using D = Simd<double, 1, ScalarIsa>;
    const std::size_t count = s.vertices.size();
    const Vec3d n = normalize(to_world.inverse().normal_by_inverse(area_normal(s.vertices)));
    Vec3d centroid{0, 0, 0};
    for (const Vec3d& q : s.vertices) centroid += q / static_cast<double>(count);
    const SurfaceNearest foot = closest_on_plane(to_world.point(centroid), n, p);
    const int i = (dominant_axis(n) + 1) % 3, j = (dominant_axis(n) + 2) % 3;
    SurfaceNearest best;
    bool inside = false;
    each_edge(s, [&](const Vec3d& from, const Vec3d& to) {
      const Vec3d a = to_world.point(from), b = to_world.point(to);
      const auto edge =
          closest_on_edge(oktett::broadcast<D>(p), oktett::broadcast<D>(a), oktett::broadcast<D>(b));
      best.keep_nearer(p, {only_lane(edge.d2), a + (b - a) * only_lane(edge.t), n});
      if ((a[j] > foot.point[j]) != (b[j] > foot.point[j]) &&
          foot.point[i] < a[i] + (foot.point[j] - a[j]) / (b[j] - a[j]) * (b[i] - a[i]))
        inside = !inside;
    });
    return inside ? foot : best;
  }

  template <class D, class Fetch>
  OKTETT_INLINE static SurfacePoints<D> surface(const Pool& p, const Fetch& fetch, const HitPoints<D>& hit) {
    return plane_surface({fetch(p.nx), fetch(p.ny), fetch(p.nz)}, fetch(p.offset), hit);
  }

  /// uv: position in the polygon's projected bounding rectangle, [0, 1]^2.
  static void uv(const Pool& p, std::size_t i, const Vec3d&, const Vec3d&, SurfaceInteraction& s) {
    const Vec3d n{p.nx[i], p.ny[i], p.nz[i]};
    const int a = (p.axis[i] + 1) % 3, b = (p.axis[i] + 2) % 3;
    const Box& box = p.boxes[i];
    const Vec3f e = box.extent();
    s.uv = {(s.position[a] - box.lo[a]) / (e[a] > 0 ? e[a] : 1),
            (s.position[b] - box.lo[b]) / (e[b] > 0 ? e[b] : 1)};
    // Along one of the two axes, and along the third as far as the plane rises.
    const auto along = [&](int k) {
      Vec3d v{0, 0, 0};
      v[k] = e[k], v[p.axis[i]] = -n[k] * e[k] / n[p.axis[i]];
      return Vec3f(v);
    };
    s.tangent = along(a), s.bitangent = along(b);
  }
};

}  // namespace oktett
