#include "render/transport/integrators.h"

#include <algorithm>
#include <cmath>

#include "accel/accel.h"
#include "accel/hit_place.h"
#include "core/random.h"
#include "render/sampling/owen_sobol.h"
#include "render/sampling/warp.h"
#include "render/transport/sample_dimensions.h"

namespace oktett {

// ---- Pictures of what the camera sees, without light.

namespace {

/// Half the width of the lines of shade_wire, in pixels.
constexpr float kHalfLine = 0.5f;

/// A colour that looks unlike those of other numbers, never black.
Color color_of(std::uint64_t number) {
  const std::uint64_t bits = mix_bits(number + kGoldenBits);
  const auto part = [&](int shift) { return 0.1f + 0.9f * static_cast<float>(bits >> shift & 0xff) / 255; };
  return {part(0), part(8), part(16)};
}

/// Cosine between the shading normal of the surface, textures left out, and the direction to the viewer; the
/// same from behind.
float facing(const ShadingPoint& p) { return std::abs(dot(p.surface.shading_normal, p.direction)); }

/// Distance from the hit to the nearest edge of its triangle, in pixels of the picture; infinite if there is
/// no triangle.
float pixels_to_edge(const RenderContext& context, const Wavefront& wavefront, std::size_t ray,
                     const ShadingPoint& p) {
  float nearest = std::numeric_limits<float>::infinity();
  const auto corners = triangle_corners(*context.world->accel, wavefront.hits[ray]);
  if (!corners) return nearest;
  const Vec3f n = p.surface.geometric_normal;
  Vec3f right, down;
  pixel_footprint(context.camera, wavefront.rays.rays[ray], p.surface.position, n, right, down);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f a = (*corners)[k], edge = (*corners)[(k + 1) % 3] - a;
    const Vec3f across = normalize(cross(n, edge));
    const float height = std::abs(dot(p.surface.position - a, across));
    const double along = dot(right, across), down_along = dot(down, across);
    const float per_pixel = static_cast<float>(std::sqrt(along * along + down_along * down_along));
    if (per_pixel > 0) nearest = std::min(nearest, height / per_pixel);
  }
  return nearest;
}

}  // namespace

/// The shading normal with textures in world space, [-1, 1] shown as [0, 1].
void shade_normal(const RenderContext&, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p) {
  wavefront.radiance.set(ray, p.normal * 0.5f + Vec3f{0.5f, 0.5f, 0.5f});
}

/// Distance along the view axis: white at the near end of the scene's bounds, black at the far end.
void shade_depth(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p) {
  const auto depth = static_cast<float>(camera_depth(context.camera, p.surface.position));
  const float shown = (context.far_depth - depth) / (context.far_depth - context.near_depth);
  const float grey = std::clamp(shown, 0.0f, 1.0f);
  wavefront.radiance.set(ray, {grey, grey, grey});
}

/// The colour of the material, textures included.
void shade_albedo(const RenderContext&, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p) {
  wavefront.radiance.set(ray, p.color);
}

/// The fractional parts of u and v as red and green.
void shade_uv(const RenderContext&, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p) {
  const Vec2f uv = p.surface.uv;
  wavefront.radiance.set(ray, {uv.x - std::floor(uv.x), uv.y - std::floor(uv.y), 0});
}

/// The place between the two ends of the scene's bounds, [0, 1] along x, y and z as red, green and blue.
void shade_position(const RenderContext& context, Wavefront& wavefront, std::size_t ray,
                    const ShadingPoint& p) {
  const Box& box = context.world->bounds;
  Color color;
  for (int k = 0; k < 3; ++k) {
    const float at = (p.surface.position[k] - box.lo[k]) / (box.hi[k] - box.lo[k]);
    // Flat boxes, and planes beyond the box.
    color[k] = at >= 0 ? std::min(at, 1.0f) : 0;
  }
  wavefront.radiance.set(ray, color);
}

/// A colour made of the number of the object.
void shade_object(const RenderContext&, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p) {
  wavefront.radiance.set(ray, color_of(p.surface.user));
}

/// A colour made of the numbers of the object and of the primitive in it.
void shade_primitive(const RenderContext&, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p) {
  wavefront.radiance.set(ray, color_of(std::uint64_t{p.surface.user} << 32 | p.surface.primitive));
}

/// The cosine between the shading normal and the viewer: grey on front sides, red on backs.
void shade_facing(const RenderContext&, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p) {
  const float cosine = facing(p);
  wavefront.radiance.set(ray, p.front ? Color{cosine, cosine, cosine} : Color{cosine, 0, 0});
}

/// Dark lines, one pixel wide, along the edges of triangles, on surfaces that are brighter the more they face
/// the viewer.
void shade_wire(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p) {
  const bool line = pixels_to_edge(context, wavefront, ray, p) < kHalfLine;
  const float grey = line ? 0.02f : 0.2f + 0.6f * facing(p);
  wavefront.radiance.set(ray, {grey, grey, grey});
}

// ---- Light that needs no lights.

/// Ambient occlusion: white times the cosine-weighted fraction of directions that meet nothing within the
/// radius.
void shade_ambient_occlusion(const RenderContext& context, Wavefront& wavefront, std::size_t ray,
                             const ShadingPoint& p) {
  const std::uint32_t sample = wavefront.rays.sample[ray];
  const std::uint64_t directions =
      sequence_key(wavefront.samples.key[sample], dimension(Decision::direction));
  const SquareSample at = sobol_point(wavefront.samples.number[sample], directions);
  const Vec3f direction = cosine_direction(p.ns, at);
  if (dot(direction, p.ng) <= 0) return;
  const Ray probe{offset_origin(p.surface, direction), 0, direction, context.ao_radius};
  wavefront.shadows.front().push_back(probe, static_cast<std::uint32_t>(ray), wavefront.rays.throughput[ray]);
}

}  // namespace oktett
