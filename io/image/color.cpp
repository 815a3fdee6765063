#include "io/image/color.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/math.h"

namespace oktett {
namespace {

std::uint8_t rounded_srgb(float linear) {
  return static_cast<std::uint8_t>(linear_to_srgb(linear) * 255.0f + 0.5f);
}

/// rounded_srgb as a table. An entry is for the floats that share sign, exponent and the first 7 bits of the
/// mantissa: so few that their results are one number or two in succession.
class SrgbTable {
 public:
  static constexpr float kFirst = 0x1p-13f;  ///< smaller numbers give 0

  SrgbTable() {
    for (std::size_t i = 0; i < kEntries; ++i) {
      std::uint32_t low = kFirstBits + static_cast<std::uint32_t>(i << kShift), high = low + (1u << kShift);
      const std::uint8_t number = rounded_srgb(std::bit_cast<float>(low));
      float step = std::numeric_limits<float>::max();
      if (rounded_srgb(std::bit_cast<float>(high - 1)) != number) {
        // The results grow with the number, so halving finds the least float that gives the next one.
        while (high - low > 1) {
          const std::uint32_t middle = (low + high) / 2;
          (rounded_srgb(std::bit_cast<float>(middle)) == number ? low : high) = middle;
        }
        step = std::bit_cast<float>(high);
      }
      entries_[i] = {step, number};
    }
  }

  /// For kFirst <= linear < 1.
  std::uint8_t operator()(float linear) const {
    const Entry& entry = entries_[(std::bit_cast<std::uint32_t>(linear) - kFirstBits) >> kShift];
    return static_cast<std::uint8_t>(entry.number + (linear >= entry.step ? 1 : 0));
  }

 private:
  static constexpr int kShift = 16;
  static constexpr std::uint32_t kFirstBits = std::bit_cast<std::uint32_t>(kFirst);
  static constexpr std::size_t kEntries = (std::bit_cast<std::uint32_t>(1.0f) - kFirstBits) >> kShift;
  struct Entry {
    float step;           ///< from here on the result is one more
    std::uint8_t number;  ///< the result below
  };
  std::array<Entry, kEntries> entries_;
};

}  // namespace

float linear_to_srgb(float linear) {
  if (linear <= 0.0031308f) return 12.92f * linear;
  return static_cast<float>(1.055 * portable::pow(static_cast<double>(linear), 1 / 2.4) - 0.055);
}

float srgb_to_linear(float encoded) {
  if (encoded <= 0.04045f) return encoded / 12.92f;
  return static_cast<float>(portable::pow((static_cast<double>(encoded) + 0.055) / 1.055, 2.4));
}

float decode(const ColorEncoding& encoding, float stored) {
  if (encoding.curve == TransferCurve::srgb) return srgb_to_linear(stored);
  if (encoding.curve != TransferCurve::gamma || stored <= 0) return stored;
  return static_cast<float>(
      portable::pow(static_cast<double>(stored), static_cast<double>(encoding.exponent)));
}

std::uint8_t linear_to_srgb8(float linear) {
  static const SrgbTable table;
  if (!std::isfinite(linear) || linear < SrgbTable::kFirst) return 0;
  return linear < 1 ? table(linear) : 255;
}

}  // namespace oktett
