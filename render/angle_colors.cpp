#include "render/angle_colors.h"

#include <algorithm>
#include <numbers>

#include "core/math.h"

namespace oktett {

double metal_fade(double cosine) {
  const double quarters = portable::acos(std::clamp(cosine, 0.0, 1.0)) * (2 / std::numbers::pi);
  const double from_pole = quarters - 1.12;
  return std::clamp(0.014567225 / (from_pole * from_pole) - 0.011612903, 0.0, 1.0);
}

Color film_color(double weight, double thickness, double cosines) {
  constexpr double kWavelengths[] = {700, 520, 480};
  Color color;
  for (int k = 0; k < 3; ++k)
    color[k] = static_cast<float>(std::max(
        0.0, 1 + weight * portable::cos(2 * std::numbers::pi * thickness * cosines / kWavelengths[k])));
  return color;
}

}  // namespace oktett
