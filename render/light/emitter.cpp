#include "render/light/emitter.h"

#include <cmath>

#include "render/light/emitter_kinds.h"

namespace oktett {

float color_weight(const Color& c) {
  if (!is_finite(c)) return 0;
  const auto part = [](float x) { return x > 0 ? double{x} : 0; };
  const auto mean = static_cast<float>((part(c.x) + part(c.y) + part(c.z)) / 3);
  return std::isfinite(mean) ? mean : 0;
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
