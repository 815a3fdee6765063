#include "render/rainbow.h"

#include <algorithm>
#include <cmath>

#include "core/math.h"

namespace oktett {
namespace {

double degrees_between(const Vec3d& a, const Vec3d& b) {
  return portable::acos(std::clamp(dot(a, b), -1.0, 1.0)) / kDegree;
}

/// The bow at a place across it.
RainbowColor color_at(const Rainbow& bow, double at) {
  const auto behind = std::ranges::find_if(bow.colors, [&](const RainbowColor& c) { return at <= c.at; });
  if (behind == bow.colors.end()) return bow.colors.back();
  if (behind == bow.colors.begin()) return *behind;
  const RainbowColor& before = behind[-1];
  const double part = (at - before.at) / (behind->at - before.at);
  const auto mix = [&](double a, double b) { return a + (b - a) * part; };
  const auto weight = static_cast<float>(part);
  return {at, before.color * (1 - weight) + behind->color * weight, mix(before.transmit, behind->transmit),
          mix(before.filter, behind->filter)};
}

/// How much of the bow is seen where the direction has this angle to the middle of the arc.
double arc_share(const Rainbow& bow, const Vec3d& direction, const Vec3d& axis) {
  if (bow.arc >= 360 && bow.falloff_arc >= 360) return 1;
  const auto across = [&](const Vec3d& v) { return v - axis * dot(v, axis); };
  const Vec3d side = across(direction), up = across(bow.up);
  if (!(length(side) > 0) || !(length(up) > 0)) return 1;
  const double angle = 2 * degrees_between(normalize(side), normalize(up));
  if (angle > bow.arc) return 0;
  if (angle <= bow.falloff_arc || bow.falloff_arc >= bow.arc) return 1;
  const double t = (bow.arc - angle) / (bow.arc - bow.falloff_arc);
  return t * t;
}

}  // namespace

Veil pass_rainbows(std::span<const Rainbow> rainbows, const Vec3d& direction, double distance) {
  Veil all;
  for (const Rainbow& bow : rainbows) {
    if (bow.colors.empty()) continue;
    const Vec3d axis = normalize(bow.direction);
    const double at = (degrees_between(direction, axis) - bow.angle) / bow.width + 0.5;
    if (!(at >= 0 && at <= 1)) continue;
    const RainbowColor color = color_at(bow, at);
    const double share = arc_share(bow, direction, axis);
    const double seen = std::min(1 - portable::exp(-distance / bow.distance), 1 - color.transmit) * share;
    // As POV-Ray 3.7 shows it: what is behind is filtered as far as the bow is seen.
    Color left;
    for (int k = 0; k < 3; ++k)
      left[k] = static_cast<float>((1 - seen) * (1 - seen * color.filter * (1 - double{color.color[k]})));
    all.left = all.left * left;
    all.light = all.light * left + color.color * static_cast<float>(seen);
  }
  return all;
}

}  // namespace oktett
