#pragma once
/// \file How numbers in image files encode light, and the way to linear Rec.709 and back.

#include <cstdint>

namespace oktett {

/// The curve between stored numbers in [0, 1] and linear light.
enum class TransferCurve { linear, srgb, gamma };

/// A curve with its exponent; `exponent` counts for TransferCurve::gamma only.
struct ColorEncoding {
  TransferCurve curve = TransferCurve::linear;
  float exponent = 1;
};

/// The sRGB curve of IEC 61966-2-1, continued beyond [0, 1] by its own formulas. NaN stays NaN.
float linear_to_srgb(float linear);
float srgb_to_linear(float encoded);

/// Linear light of `stored`.
float decode(const ColorEncoding& encoding, float stored);

/// `linear` through the sRGB curve, rounded to 8 bits. Values outside [0, 1] are clamped; NaN and infinities
/// give 0.
std::uint8_t linear_to_srgb8(float linear);

}  // namespace oktett
