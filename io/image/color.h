#pragma once
/// \file How numbers in image files encode light, and the way to linear Rec.709 and back.

#include <array>
#include <cstdint>
#include <optional>

#include "core/vec3.h"

namespace oktett {

/// The curve between stored numbers in [0, 1] and linear light.
enum class TransferCurve { linear, srgb, gamma };

/// Rows of a matrix.
using ColorMatrix = std::array<float, 9>;

/// A curve with its exponent, which counts for TransferCurve::gamma only, and the way from the primaries of
/// its light to those of Rec.709; nothing if they are the same.
struct ColorEncoding {
  TransferCurve curve = TransferCurve::linear;
  float exponent = 1;
  std::optional<ColorMatrix> to_rec709 = std::nullopt;

  /// Whether stored numbers are linear Rec.709.
  bool is_plain() const { return curve == TransferCurve::linear && !to_rec709; }
};

/// CIE 1931 x and y of red, green, blue and white.
using Chromaticities = std::array<float, 8>;

/// The way from light of these primaries to Rec.709: white becomes white, by Bradford's adaptation. Nothing
/// if they are those of Rec.709 to four digits. Throws Error if they are those of no colours.
std::optional<ColorMatrix> to_rec709(const Chromaticities& chromaticities);

/// The product with a colour.
Color transformed(const ColorMatrix& m, const Color& c);

/// The sRGB curve of IEC 61966-2-1, continued beyond [0, 1] by its own formulas. NaN stays NaN.
float linear_to_srgb(float linear);
float srgb_to_linear(float encoded);

/// Linear light of `stored`.
float decode(const ColorEncoding& encoding, float stored);

/// `linear` through the sRGB curve, rounded to 8 bits. Values outside [0, 1] are clamped; NaN and infinities
/// give 0.
std::uint8_t linear_to_srgb8(float linear);
/// The same with 16 bits.
std::uint16_t linear_to_srgb16(float linear);

}  // namespace oktett
