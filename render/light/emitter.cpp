#include "render/light/emitter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"
#include "render/light/emitter_lanes.h"

namespace oktett {

float color_weight(const Color& c) {
  if (!is_finite(c)) return 0;
  const auto part = [](float x) { return x > 0 ? double{x} : 0; };
  const auto mean = static_cast<float>((part(c.x) + part(c.y) + part(c.z)) / 3);
  return std::isfinite(mean) ? mean : 0;
}

Vec3d around(const Vec3d& axis, double one_minus_cos, double turn) {
  return only_lane(around_lanes(broadcast<Lane>(axis), Lane(one_minus_cos), Lane(turn)));
}

std::optional<LightSample> only_sample(const LightSamples<Lane>& s, const Color& radiance) {
  if (none(s.found) || !is_finite(radiance)) return std::nullopt;
  return LightSample{.direction = only_lane(s.direction),
                     .distance = only_lane(s.distance),
                     .radiance = radiance,
                     .pdf = only_lane(s.pdf),
                     .delta = false,
                     .emitter = 0,
                     .u = static_cast<float>(only_lane(s.u)),
                     .v = static_cast<float>(only_lane(s.v))};
}

std::optional<LightSample> sample_emitter(const Emitter& emitter, const LightPoint& point,
                                          const SquareSample& s) {
  return std::visit([&](const auto& e) { return sample_kind(e, point, s); }, emitter);
}

float emitter_pdf(const Emitter& emitter, const LightPoint& point, const Vec3f& direction, float distance) {
  const float pdf =
      std::visit([&](const auto& e) { return pdf_kind(e, point, direction, distance); }, emitter);
  return pdf > 0 && std::isfinite(pdf) ? pdf : 0;
}

/// The density, per solid angle, of directions from a point of a sphere into it.
static constexpr double kInwardPdf = 1 / (2 * std::numbers::pi);

std::optional<LightSample> sample_own_emitter(const Emitter& emitter, const LightPoint& point,
                                              const SquareSample& s) {
  const auto* sphere = std::get_if<SphereEmitter>(&emitter);
  if (sphere == nullptr || !sphere->both_sides) return std::nullopt;
  const Vec3d inward = normalize(Vec3d(sphere->center) - Vec3d(point.position));
  const Vec3d chord = around(inward, s.x, s.y) * (2 * (1 - s.x) * double{sphere->radius});
  return sample_at(chord, sphere->radiance, kInwardPdf, false);
}

float own_emitter_pdf(const Emitter& emitter) {
  const auto* sphere = std::get_if<SphereEmitter>(&emitter);
  return sphere != nullptr && sphere->both_sides ? static_cast<float>(kInwardPdf) : 0;
}

std::optional<LightBounds> light_bounds(const Emitter& emitter) {
  const auto bounds = std::visit(
      [](const auto& e) -> std::optional<LightBounds> {
        if constexpr (requires { bounds_kind(e); }) return bounds_kind(e);
        return std::nullopt;
      },
      emitter);
  if (!bounds || !(bounds->power > 0) || !std::isfinite(bounds->power)) return std::nullopt;
  const bool finite = is_finite(bounds->box.lo) && is_finite(bounds->box.hi) && is_finite(bounds->axis) &&
                      std::isfinite(bounds->spread) && std::isfinite(bounds->reach);
  return finite ? bounds : std::nullopt;
}

}  // namespace oktett
