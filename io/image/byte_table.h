#pragma once
/// \file The bytes that a rising function makes of floats below 1, by a table.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace oktett {

/// An entry is for the floats that share sign, exponent and the first 23 - kShift bits of the mantissa: so
/// few that the function gives one byte or two in succession.
template <int kShift>
class ByteTable {
 public:
  static constexpr float kFirst = 0x1p-13f;

  /// `of(x)` for kFirst <= x < 1 rises by at most one in each entry, and is 0 for smaller x.
  template <class Of>
  explicit ByteTable(const Of& of) {
    entries_.resize(kEntries);
    for (std::size_t i = 0; i < kEntries; ++i) {
      std::uint32_t low = kFirstBits + static_cast<std::uint32_t>(i << kShift), high = low + (1u << kShift);
      const std::uint8_t number = of(std::bit_cast<float>(low));
      float step = std::numeric_limits<float>::max();
      if (of(std::bit_cast<float>(high - 1)) != number) {
        // The results grow with the number, so halving finds the least float that gives the next one.
        while (high - low > 1) {
          const std::uint32_t middle = (low + high) / 2;
          (of(std::bit_cast<float>(middle)) == number ? low : high) = middle;
        }
        step = std::bit_cast<float>(high);
      }
      entries_[i] = {step, number};
    }
  }

  /// Of any number: 0 for those below kFirst, which are negative, NaN and infinite ones, too; 255 from 1 on.
  std::uint8_t operator()(float x) const {
    if (!(x >= kFirst) || x == std::numeric_limits<float>::infinity()) return 0;
    if (x >= 1) return 255;
    const Entry& entry = entries_[(std::bit_cast<std::uint32_t>(x) - kFirstBits) >> kShift];
    return static_cast<std::uint8_t>(entry.number + (x >= entry.step ? 1 : 0));
  }

 private:
  static constexpr std::uint32_t kFirstBits = std::bit_cast<std::uint32_t>(kFirst);
  static constexpr std::size_t kEntries = (std::bit_cast<std::uint32_t>(1.0f) - kFirstBits) >> kShift;
  struct Entry {
    float step;           ///< from here on the result is one more
    std::uint8_t number;  ///< the result below
  };
  std::vector<Entry> entries_;
};

}  // namespace oktett
