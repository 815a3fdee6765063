#include "io/image/color.h"

#include <cmath>

namespace oktett {

float linear_to_srgb(float linear) {
  if (linear <= 0.0031308f) return 12.92f * linear;
  return static_cast<float>(1.055 * std::pow(static_cast<double>(linear), 1 / 2.4) - 0.055);
}

float srgb_to_linear(float encoded) {
  if (encoded <= 0.04045f) return encoded / 12.92f;
  return static_cast<float>(std::pow((static_cast<double>(encoded) + 0.055) / 1.055, 2.4));
}

float decode(const ColorEncoding& encoding, float stored) {
  if (encoding.curve == TransferCurve::srgb) return srgb_to_linear(stored);
  return encoding.curve == TransferCurve::gamma && !(stored <= 0) ? std::pow(stored, encoding.exponent)
                                                                  : stored;
}

std::uint8_t linear_to_srgb8(float linear) {
  if (!std::isfinite(linear) || linear <= 0) return 0;
  if (linear >= 1) return 255;
  return static_cast<std::uint8_t>(linear_to_srgb(linear) * 255.0f + 0.5f);
}

}  // namespace oktett
