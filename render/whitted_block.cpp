#include "render/whitted_block.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/per_set.h"
#include "core/platform.h"
#include "render/direct_light.h"
#include "render/integrators.h"

namespace oktett {
namespace {

constexpr std::size_t kMost = InteractionBlock::kMost;

/// Hits and one light. Loops over the columns are written for compilers to turn into vector code: without
/// branches, and on all of the columns up to a multiple of eight.
struct Columns {
  std::size_t count;  ///< a multiple of eight; what follows the last hit repeats the first
  float direction[3][kMost];
  float ng[3][kMost], ns[3][kMost];  ///< turned towards the ray's origin, see ShadingPoint

  float l[3][kMost];       ///< unit vector to the light
  float origin[3][kMost];  ///< of the shadow ray
  float falloff[kMost];    ///< 1 / squared distance
  float cosine[kMost];     ///< between ns and l; 0 where the light is behind
  float highlight[kMost];  ///< cosine between the mirrored light and the viewer
  float power[kMost];      ///< highlight_power of it, where exponents are raised to by squaring
};

/// face_ray of render/shading_point.cpp.
OKTETT_PER_SET void face_rays(const InteractionBlock& s, Columns& c) {
  constexpr float kLeast = 1e-3f;
  for (std::size_t i = 0; i < c.count; ++i) {
    const float dx = c.direction[0][i], dy = c.direction[1][i], dz = c.direction[2][i];
    const float nx = s.geometric_normal[0][i], ny = s.geometric_normal[1][i], nz = s.geometric_normal[2][i];
    const float side = dx * nx + dy * ny + dz * nz > 0 ? -1.0f : 1.0f;
    const float gx = nx * side, gy = ny * side, gz = nz * side;
    c.ng[0][i] = gx, c.ng[1][i] = gy, c.ng[2][i] = gz;
    float x = s.shading_normal[0][i], y = s.shading_normal[1][i], z = s.shading_normal[2][i];
    const float turn = x * gx + y * gy + z * gz < 0 ? -1.0f : 1.0f;
    x = x * turn, y = y * turn, z = z * turn;
    const float away = dx * x + dy * y + dz * z;
    const float bend = away + kLeast;
    const float bx = x - dx * bend, by = y - dy * bend, bz = z - dz * bend;
    const float length = std::sqrt(bx * bx + by * by + bz * bz);
    const bool bent = away > -kLeast;
    c.ns[0][i] = bent ? bx / length : x;
    c.ns[1][i] = bent ? by / length : y;
    c.ns[2][i] = bent ? bz / length : z;
  }
}

OKTETT_PER_SET void turn_to_light(const InteractionBlock& s, const LightSource& light, Columns& c) {
  if (light.directional) {
    for (int k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < c.count; ++i) c.l[k][i] = light.place[k];
    return;
  }
  const double px = light.place.x, py = light.place.y, pz = light.place.z;
  for (std::size_t i = 0; i < c.count; ++i) {
    const double x = px - static_cast<double>(s.position[0][i]),
                 y = py - static_cast<double>(s.position[1][i]),
                 z = pz - static_cast<double>(s.position[2][i]);
    const double square = x * x + y * y + z * z, distance = std::sqrt(square);
    c.l[0][i] = static_cast<float>(x / distance);
    c.l[1][i] = static_cast<float>(y / distance);
    c.l[2][i] = static_cast<float>(z / distance);
    c.falloff[i] = static_cast<float>(1 / square);
  }
}

/// move_away of accel/surface/offset_origin.h without branches: floats in the order of their numbers.
inline float move_away_evenly(float p, float offset) {
  constexpr std::int32_t kLowest = std::numeric_limits<std::int32_t>::min(), kInfinite = 0x7f800000;
  const float sum = p + offset;
  const auto mirrored = [](std::int32_t bits) { return bits < 0 ? kLowest - bits : bits; };
  std::int32_t place = mirrored(std::bit_cast<std::int32_t>(sum)) + ((offset > 0) - (offset < 0));
  place = place > kInfinite ? kInfinite : place;
  place = place < -kInfinite ? -kInfinite : place;
  const float moved = std::bit_cast<float>(mirrored(place));
  return sum == sum ? moved : sum;
}

/// offset_origin of accel/surface/offset_origin.h towards `l`.
OKTETT_PER_SET void leave_surfaces(const InteractionBlock& s, Columns& c) {
  for (std::size_t i = 0; i < c.count; ++i) {
    const float nx = s.geometric_normal[0][i], ny = s.geometric_normal[1][i], nz = s.geometric_normal[2][i];
    const float reach = std::abs(nx) * s.position_error[0][i] + std::abs(ny) * s.position_error[1][i] +
                        std::abs(nz) * s.position_error[2][i];
    const float side = c.l[0][i] * nx + c.l[1][i] * ny + c.l[2][i] * nz < 0 ? -reach : reach;
    c.origin[0][i] = move_away_evenly(s.position[0][i], nx * side);
    c.origin[1][i] = move_away_evenly(s.position[1][i], ny * side);
    c.origin[2][i] = move_away_evenly(s.position[2][i], nz * side);
  }
}

/// The cosines of phong().
OKTETT_PER_SET void measure_angles(Columns& c) {
  for (std::size_t i = 0; i < c.count; ++i) {
    const float lx = c.l[0][i], ly = c.l[1][i], lz = c.l[2][i];
    const float dx = c.direction[0][i], dy = c.direction[1][i], dz = c.direction[2][i];
    const float x = c.ns[0][i], y = c.ns[1][i], z = c.ns[2][i];
    const float cosine = x * lx + y * ly + z * lz;
    const float above = c.ng[0][i] * lx + c.ng[1][i] * ly + c.ng[2][i] * lz;
    c.highlight[i] = (lx * dx + ly * dy + lz * dz) - 2 * cosine * (x * dx + y * dy + z * dz);
    c.cosine[i] = above <= 0 ? 0.0f : cosine;
  }
}

/// Highlights to the power of `exponent`: portable::whole_power for all, digit by digit of the exponents.
OKTETT_PER_SET void raise_highlights(const std::int32_t* exponent, std::int32_t greatest, Columns& c) {
  double x[kMost], product[kMost];
  for (std::size_t i = 0; i < c.count; ++i) {
    x[i] = static_cast<double>(1.0f < c.highlight[i] ? 1.0f : c.highlight[i]);
    product[i] = 1;
  }
  for (std::int32_t digit = 1; digit <= greatest; digit *= 2) {
    for (std::size_t i = 0; i < c.count; ++i) {
      const double longer = product[i] * x[i];
      product[i] = (exponent[i] & digit) != 0 ? longer : product[i];
      x[i] = x[i] * x[i];
    }
  }
  for (std::size_t i = 0; i < c.count; ++i) c.power[i] = static_cast<float>(product[i]);
}

Vec3f get(const float (&column)[3][kMost], std::size_t i) { return InteractionBlock::get(column, i); }

/// The shadow ray of hit `k` of the columns.
Ray shadow_ray(const Columns& c, std::size_t k, const LightSource& light) {
  Ray ray;
  ray.origin = get(c.origin, k);
  if (light.directional) {
    ray.direction = light.place;
  } else {
    ray.direction = light.place - ray.origin;
    ray.tmax = kBeforeLight;
  }
  return ray;
}

/// Hit `i` by itself: all of it, or if it is plain, and thus lit already, its mirror and what shines through.
OKTETT_NOINLINE void shade_alone(const RenderContext& context, Wavefront& wavefront, std::uint32_t i,
                                 const SurfaceInteraction& found, bool plain) {
  const ShadingPoint p =
      shading_point(context, wavefront.rays.rays[i], wavefront.hits[i],
                    {wavefront.rays.distance[i], wavefront.rays.from_camera[i] != 0}, found);
  if (plain) return push_specular(context, wavefront, i, p, wavefront.rays.throughput[i]);
  if (wavefront.rays.from_camera[i])
    wavefront.samples.alpha[wavefront.rays.sample[i]] += wavefront.rays.throughput[i].x * p.opacity;
  shade_whitted(context, wavefront, i, p);
}

}  // namespace

void shade_whitted_block(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* which,
                         std::size_t count, const InteractionBlock& found) {
  Columns c;
  c.count = (count + 7) / 8 * 8;
  const Material* materials[kMost];
  bool plain[kMost];
  std::int32_t exponent[kMost], greatest = 0;
  for (std::size_t k = 0; k < count; ++k) {
    materials[k] = &material_at(*context.world, found.user[k], found.material_slot[k]);
    plain[k] = context.textures == nullptr || !has_textures(*materials[k]);
    const Material& m = *materials[k];
    exponent[k] = m.specular != 0 && by_squaring(m.phong) ? static_cast<std::int32_t>(m.phong) : 0;
    greatest = std::max(greatest, exponent[k]);
    for (int axis = 0; axis < 3; ++axis) c.direction[axis][k] = wavefront.rays.rays.direction[axis][which[k]];
  }
  // What follows the last hit may hold anything, but denormals would be slow.
  for (std::size_t k = count; k < c.count; ++k) {
    exponent[k] = 0;
    for (int axis = 0; axis < 3; ++axis) c.direction[axis][k] = 0;
  }
  face_rays(found, c);
  for (std::size_t n = 0; n < context.lights.size(); ++n) {
    const LightSource& light = context.lights[n];
    turn_to_light(found, light, c);
    leave_surfaces(found, c);
    measure_angles(c);
    raise_highlights(exponent, greatest, c);
    // Room for all of them: asking for it ray by ray and column by column takes longer than writing.
    ShadowQueue& queue = wavefront.shadows[n];
    std::size_t end = queue.size();
    queue.resize_uninitialized(end + count);
    for (std::size_t k = 0; k < count; ++k) {
      if (!plain[k] || c.cosine[k] <= 0) continue;
      const Material& m = *materials[k];
      const Color shine = phong_sum(m, m.color, m.specular_color, c.cosine[k], c.highlight[k], [&] {
        if (by_squaring(m.phong)) return c.power[k];
        return highlight_power(std::min(c.highlight[k], 1.0f), m.phong);
      });
      const Color color = !light.directional && light.falloff ? light.color * c.falloff[k] : light.color;
      const Color arriving = wavefront.rays.throughput[which[k]] * shine * color;
      if (arriving == Color{0, 0, 0}) continue;
      queue.set(end++, shadow_ray(c, k, light), which[k], arriving);
    }
    queue.resize_uninitialized(end);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = which[k];
    const Material& m = *materials[k];
    if (plain[k]) {
      if (wavefront.rays.from_camera[i])
        wavefront.samples.alpha[wavefront.rays.sample[i]] += wavefront.rays.throughput[i].x;
      wavefront.radiance[i] +=
          wavefront.rays.throughput[i] * (m.emission + m.color * m.ambient * context.ambient_light);
    }
    if (!plain[k] || m.reflection != 0 || m.transparency != 0)
      shade_alone(context, wavefront, i, found[k], plain[k]);
  }
}

}  // namespace oktett
