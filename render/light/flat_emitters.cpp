/// \file Triangles, parallelograms and disks.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"
#include "render/light/flat_lanes.h"

namespace oktett {

/// `position` relative to the point.
static Vec3<Lane> seen_from(const LightPoint& p, const Vec3f& position) {
  return broadcast<Lane>(Vec3d(position) - Vec3d(p.position));
}

static Lane::M one_lane(bool x) { return Lane::M::from_bits(x ? 1 : 0); }

/// The vector to what a ray meets.
static Vec3<Lane> along(const Vec3f& direction, float distance) {
  return broadcast<Lane>(Vec3d(direction) * double{distance});
}

// Triangles.

static TriangleViews<Lane> view(const TriangleEmitter& e, const LightPoint& p) {
  const Vec3d a(e.a);
  return {seen_from(p, e.a), broadcast<Lane>(Vec3d(e.b) - a), broadcast<Lane>(Vec3d(e.c) - a),
          one_lane(e.both_sides)};
}

std::optional<LightSample> sample_kind(const TriangleEmitter& e, const LightPoint& p, const SquareSample& s) {
  return only_sample(view(e, p).sample(Lane(s.x), Lane(s.y)), e.radiance);
}

float pdf_kind(const TriangleEmitter& e, const LightPoint& p, const Vec3f& direction, float distance) {
  return static_cast<float>(only_lane(view(e, p).pdf(along(direction, distance))));
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

static RectangleViews<Lane> view(const RectangleEmitter& e, const LightPoint& p) {
  return {seen_from(p, e.corner), broadcast<Lane>(Vec3d(e.edge_u)), broadcast<Lane>(Vec3d(e.edge_v)),
          one_lane(e.both_sides)};
}

std::optional<LightSample> sample_kind(const RectangleEmitter& e, const LightPoint& p,
                                       const SquareSample& s) {
  return only_sample(view(e, p).sample(Lane(s.x), Lane(s.y)), e.radiance);
}

float pdf_kind(const RectangleEmitter& e, const LightPoint& p, const Vec3f& direction, float distance) {
  return static_cast<float>(only_lane(view(e, p).pdf(along(direction, distance))));
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

static DiskViews<Lane> view(const DiskEmitter& e, const LightPoint& p) {
  return {seen_from(p, e.center), broadcast<Lane>(Vec3d(e.normal)), Lane(e.radius), one_lane(e.both_sides)};
}

std::optional<LightSample> sample_kind(const DiskEmitter& e, const LightPoint& p, const SquareSample& s) {
  return only_sample(view(e, p).sample(Lane(s.x), Lane(s.y)), e.radiance);
}

float pdf_kind(const DiskEmitter& e, const LightPoint& p, const Vec3f& direction, float distance) {
  return static_cast<float>(only_lane(view(e, p).pdf(along(direction, distance))));
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
