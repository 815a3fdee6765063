/// \file Triangles, parallelograms and disks.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"
#include "render/light/emitter_lanes.h"
#include "render/light/spherical_triangle.h"

namespace oktett {

using Lane = Simd<double, 1, ScalarIsa>;

/// What the kinds share: the plane of an emitter as seen from a point.
struct Facing {
  Vec3d normal;   ///< not unit: its length is twice the area of a triangle, the area of a parallelogram
  double height;  ///< of the point over the front of the plane, times the length of the normal

  /// Whether the emitter lights points on this side of its plane.
  bool lights(bool both_sides) const { return both_sides ? height != 0 : height > 0; }
};

/// `to` goes from the point to any place in the plane.
static Facing facing(const Vec3d& normal, const Vec3d& to) { return {normal, -dot(normal, to)}; }

/// The density, per solid angle, of points that are uniform over an area, at the end of `to`. `normal` is as
/// long as the area is large.
static double area_pdf(const Vec3d& to, const Vec3d& normal) {
  const double square = dot(to, to);
  return square * std::sqrt(square) / std::abs(dot(to, normal));
}

namespace {

/// Two edges that leave a corner, relative to a point.
struct CornerView {
  Vec3d corner, edge_u, edge_v;
  Facing side;

  CornerView(const Vec3f& at, const Vec3d& u, const Vec3d& v, const LightPoint& p)
      : corner(Vec3d(at) - Vec3d(p.position)),
        edge_u(u),
        edge_v(v),
        side(facing(cross(edge_u, edge_v), corner)) {}

  Vec3d place(double u, double v) const { return corner + edge_u * u + edge_v * v; }
};

}  // namespace

// Triangles.

namespace {

/// A triangle relative to a point.
struct TriangleView : CornerView {
  TriangleView(const TriangleEmitter& e, const LightPoint& p)
      : CornerView(e.a, Vec3d(e.b) - Vec3d(e.a), Vec3d(e.c) - Vec3d(e.a), p) {}

  SphericalTriangle spherical() const { return {corner, corner + edge_u, corner + edge_v}; }
};

}  // namespace

/// Where the ray along `direction` meets the plane of the triangle, as weights of the second and third corner
/// that are clamped to the triangle.
static void triangle_place(const TriangleView& t, const Vec3d& direction, double& u, double& v) {
  const double volume = dot(t.side.normal, direction);
  u = std::clamp(dot(cross(t.edge_v, t.corner), direction) / volume, 0.0, 1.0);
  v = std::clamp(dot(cross(t.corner, t.edge_u), direction) / volume, 0.0, 1.0 - u);
}

std::optional<LightSample> sample_kind(const TriangleEmitter& e, const LightPoint& p, const SquareSample& s) {
  const TriangleView t(e, p);
  if (!t.side.lights(e.both_sides)) return std::nullopt;
  const SphericalTriangle spherical = t.spherical();
  double u, v;
  if (spherical.solid_angle() >= kLeastSolidAngle) {
    triangle_place(t, spherical.direction(s), u, v);
    return sample_at(t.place(u, v), e.radiance, 1 / spherical.solid_angle(), false, u, v);
  }
  const double root = std::sqrt(s.x);
  u = root * (1 - s.y), v = root * s.y;
  const Vec3d to = t.place(u, v);
  return sample_at(to, e.radiance, area_pdf(to, t.side.normal * 0.5), false, u, v);
}

float pdf_kind(const TriangleEmitter& e, const LightPoint& p, const Vec3f& direction, float distance) {
  const TriangleView t(e, p);
  if (!t.side.lights(e.both_sides)) return 0;
  const double angle = t.spherical().solid_angle();
  if (angle >= kLeastSolidAngle) return static_cast<float>(1 / angle);
  return static_cast<float>(area_pdf(Vec3d(direction) * double{distance}, t.side.normal * 0.5));
}

/// The bounds of a flat thing.
static LightBounds flat_bounds(const Box& box, const Vec3d& normal, double area, const Color& radiance,
                               bool both_sides) {
  return {.box = box,
          .axis = Vec3f(normalize(normal)),
          .spread = 0,
          .reach = static_cast<float>(std::numbers::pi / 2),
          .both_sides = both_sides,
          .power = static_cast<float>(color_weight(radiance) * area)};
}

std::optional<LightBounds> bounds_kind(const TriangleEmitter& e) {
  const Vec3d normal = cross(Vec3d(e.b) - Vec3d(e.a), Vec3d(e.c) - Vec3d(e.a));
  Box box;
  for (const Vec3f& corner : {e.a, e.b, e.c}) box.grow(corner);
  return flat_bounds(box, normal, length(normal) / 2, e.radiance, e.both_sides);
}

// Parallelograms.

namespace {

/// A parallelogram relative to a point.
struct RectangleView : CornerView {
  RectangleView(const RectangleEmitter& e, const LightPoint& p)
      : CornerView(e.corner, Vec3d(e.edge_u), Vec3d(e.edge_v), p) {}

  /// The same in the plane's own coordinates, for perpendicular edges.
  SphericalRectangle<Lane> spherical(double length_u, double length_v) const {
    const double x = dot(corner, edge_u) / length_u, y = dot(corner, edge_v) / length_v;
    return {x, x + length_u, y, y + length_v, std::abs(side.height) / length(side.normal)};
  }

  bool perpendicular() const {
    const double skew = dot(edge_u, edge_v);
    return skew * skew <= 1e-12 * dot(edge_u, edge_u) * dot(edge_v, edge_v);
  }
};

}  // namespace

std::optional<LightSample> sample_kind(const RectangleEmitter& e, const LightPoint& p,
                                       const SquareSample& s) {
  const RectangleViews<Lane> view{broadcast<Lane>(Vec3d(e.corner) - Vec3d(p.position)),
                                  broadcast<Lane>(Vec3d(e.edge_u)), broadcast<Lane>(Vec3d(e.edge_v)),
                                  Lane::M::from_bits(e.both_sides ? 1 : 0)};
  return only_sample(view.sample(Lane(s.x), Lane(s.y)), e.radiance);
}

float pdf_kind(const RectangleEmitter& e, const LightPoint& p, const Vec3f& direction, float distance) {
  const RectangleView r(e, p);
  if (!r.side.lights(e.both_sides)) return 0;
  if (r.perpendicular()) {
    const double angle = only_lane(r.spherical(length(r.edge_u), length(r.edge_v)).solid_angle());
    if (angle >= kLeastSolidAngle) return static_cast<float>(1 / angle);
  }
  return static_cast<float>(area_pdf(Vec3d(direction) * double{distance}, r.side.normal));
}

std::optional<LightBounds> bounds_kind(const RectangleEmitter& e) {
  const Vec3d normal = cross(Vec3d(e.edge_u), Vec3d(e.edge_v));
  Box box;
  for (const Vec3f& corner :
       {e.corner, e.corner + e.edge_u, e.corner + e.edge_v, e.corner + e.edge_u + e.edge_v})
    box.grow(corner);
  return flat_bounds(box, normal, length(normal), e.radiance, e.both_sides);
}

// Disks.

namespace {

/// A disk relative to a point.
struct DiskView {
  Vec3d center, normal;
  double area;
  Facing side;
  /// 1 - cosine of half the angle of the circle around the place below the point that fits into the disk; 0
  /// if the circle is smaller than its distance.
  double cap = 0;

  DiskView(const DiskEmitter& e, const LightPoint& p)
      : center(Vec3d(e.center) - Vec3d(p.position)),
        normal(normalize(Vec3d(e.normal))),
        area(std::numbers::pi * e.radius * e.radius),
        side(facing(normal, center)) {
    const double height = std::abs(side.height), radius = e.radius - length(center + normal * side.height);
    if (radius > height) cap = 1 - height / std::sqrt(height * height + radius * radius);
  }

  double pdf(const Vec3d& to) const {
    const double by_area = area_pdf(to, normal * area);
    if (cap == 0) return by_area;
    const bool in_cap = std::abs(dot(normal, to)) >= (1 - cap) * length(to);
    return 0.5 * by_area + (in_cap ? 0.25 / (std::numbers::pi * cap) : 0);
  }
};

}  // namespace

std::optional<LightSample> sample_kind(const DiskEmitter& e, const LightPoint& p, const SquareSample& s) {
  const DiskView disk(e, p);
  if (!disk.side.lights(e.both_sides)) return std::nullopt;
  if (disk.cap > 0 && s.x < 0.5) {
    const Vec3d down = disk.side.height > 0 ? -disk.normal : disk.normal;
    const double depth = 2 * s.x * disk.cap;
    const Vec3d to = around(down, depth, s.y) * (std::abs(disk.side.height) / (1 - depth));
    return sample_at(to, e.radiance, disk.pdf(to), false);
  }
  const double part = disk.cap > 0 ? 2 * s.x - 1 : s.x;
  Vec3d tangent, bitangent;
  make_basis(disk.normal, tangent, bitangent);
  const double radius = e.radius * std::sqrt(part), angle = 2 * std::numbers::pi * s.y;
  const Vec3d to =
      disk.center + tangent * (radius * portable::cos(angle)) + bitangent * (radius * portable::sin(angle));
  return sample_at(to, e.radiance, disk.pdf(to), false);
}

float pdf_kind(const DiskEmitter& e, const LightPoint& p, const Vec3f& direction, float distance) {
  const DiskView disk(e, p);
  if (!disk.side.lights(e.both_sides)) return 0;
  return static_cast<float>(disk.pdf(Vec3d(direction) * double{distance}));
}

std::optional<LightBounds> bounds_kind(const DiskEmitter& e) {
  const Vec3d n = normalize(Vec3d(e.normal));
  const double r = e.radius;
  const Vec3d half{r * std::sqrt(std::max(0.0, 1 - n.x * n.x)), r * std::sqrt(std::max(0.0, 1 - n.y * n.y)),
                   r * std::sqrt(std::max(0.0, 1 - n.z * n.z))};
  const Box box{round_down(Vec3d(e.center) - half), round_up(Vec3d(e.center) + half)};
  return flat_bounds(box, n, r > 0 ? std::numbers::pi * r * r : 0, e.radiance, e.both_sides);
}

}  // namespace oktett
