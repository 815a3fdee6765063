#include "render/tone.h"

#include <algorithm>

#include "core/math.h"
#include "core/mesh_attributes.h"

namespace oktett {
namespace {

/// The curve of Hable (2010), where 11.2 shows as white, with his exposure of 2.
double hable(double x) {
  constexpr double kA = 0.15, kB = 0.5, kC = 0.1, kD = 0.2, kE = 0.02, kF = 0.3;
  const auto curve = [](double v) {
    return (v * (kA * v + kC * kB) + kD * kE) / (v * (kA * v + kB) + kD * kF) - kE / kF;
  };
  return curve(2 * x) / curve(11.2);
}

/// The fit of Hill (2016): sRGB to the Academy's rendering space, one curve, and back.
Vec3d aces(const Vec3d& c) {
  const Vec3d in{0.59719 * c.x + 0.35458 * c.y + 0.04823 * c.z, 0.076 * c.x + 0.90834 * c.y + 0.01566 * c.z,
                 0.0284 * c.x + 0.13383 * c.y + 0.83777 * c.z};
  const auto curve = [](double v) {
    return (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.432951) + 0.238081);
  };
  const Vec3d v{curve(in.x), curve(in.y), curve(in.z)};
  return {1.60475 * v.x - 0.53108 * v.y - 0.07367 * v.z, -0.10208 * v.x + 1.10813 * v.y - 0.00605 * v.z,
          -0.00327 * v.x - 0.07276 * v.y + 1.07602 * v.z};
}

/// The PBR Neutral Tone Mapper of Khronos (2024).
Vec3d neutral(Vec3d c) {
  constexpr double kStart = 0.8 - 0.04, kDesaturation = 0.15, kRoom = 1 - kStart;
  const double least = std::min({c.x, c.y, c.z});
  const double offset = least < 0.08 ? least - 6.25 * least * least : 0.04;
  c -= Vec3d{offset, offset, offset};
  const double peak = max_component(c);
  if (peak < kStart) return c;
  const double shown = 1 - kRoom * kRoom / (peak + kRoom - kStart);
  const double white = 1 - 1 / (kDesaturation * (peak - shown) + 1);
  return c * (shown / peak) * (1 - white) + Vec3d{shown, shown, shown} * white;
}

}  // namespace

Color toned(const Tone& tone, const Color& c) {
  if (tone.is_identity() || !is_finite(c)) return c;
  Vec3d given(c);
  if (tone.gamma != 1)
    for (int k = 0; k < 3; ++k)
      given[k] = given[k] > 0 ? portable::exp2(tone.gamma * portable::log2(given[k])) : 0;
  const Vec3d light = given * portable::exp2(tone.exposure);
  if (tone.kind == ToneKind::srgb) return Color(light);
  const Vec3d seen{std::max(light.x, 0.0), std::max(light.y, 0.0), std::max(light.z, 0.0)};
  Vec3d shown;
  if (tone.kind == ToneKind::raw)
    for (int k = 0; k < 3; ++k) shown[k] = double{linear_of_srgb(std::min(seen[k], 1.0))};
  else if (tone.kind == ToneKind::filmic)
    shown = {hable(seen.x), hable(seen.y), hable(seen.z)};
  else
    shown = tone.kind == ToneKind::aces ? aces(seen) : neutral(seen);
  const auto cut = [](double v) { return static_cast<float>(std::clamp(v, 0.0, 1.0)); };
  return {cut(shown.x), cut(shown.y), cut(shown.z)};
}

}  // namespace oktett
