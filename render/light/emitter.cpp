#include "render/light/emitter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"
#include "render/light/emitter_kinds.h"

namespace oktett {

float color_weight(const Color& c) {
  if (!is_finite(c)) return 0;
  const auto part = [](float x) { return x > 0 ? double{x} : 0; };
  const auto mean = static_cast<float>((part(c.x) + part(c.y) + part(c.z)) / 3);
  return std::isfinite(mean) ? mean : 0;
}

Vec3d around(const Vec3d& axis, double one_minus_cos, double turn) {
  Vec3d tangent, bitangent;
  make_basis(axis, tangent, bitangent);
  const double sine = std::sqrt(std::max(0.0, one_minus_cos * (2 - one_minus_cos)));
  const double angle = 2 * std::numbers::pi * turn;
  return tangent * (sine * portable::cos(angle)) + bitangent * (sine * portable::sin(angle)) +
         axis * (1 - one_minus_cos);
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
