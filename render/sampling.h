#pragma once
/// \file Sample points spread evenly over the unit square, and directions made from them.

#include <cstdint>

#include "core/random.h"
#include "core/vec3.h"

namespace oktett {

/// A point of the unit square, [0, 1) in both coordinates.
struct SquareSample {
  double x = 0, y = 0;
};

/// The only point of every pattern of one point.
inline constexpr SquareSample kSquareCentre{0.5, 0.5};

/// A pattern of `count` points chosen by `key`: correlated multi-jittered sampling (Kensler 2013).
///
/// The pattern has m = floor(sqrt(count)) columns and ceil(count / m) rows. If they multiply to `count`, each
/// cell of that grid holds exactly one point. For any count, each of `count` equal intervals of y holds
/// exactly one point, and each sub-column of a cell's x range holds at most one. Points come in random order.
/// A single point is the centre of the square.
///
/// Departs from the paper in its hash functions: permutations and jitter are those of core/random.h.
class StratifiedPattern {
 public:
  /// `whole`: most of the points will be asked for, so tables are prepared.
  StratifiedPattern(std::uint32_t count, std::uint64_t key, bool whole = true);
  /// Point `sample` < count.
  SquareSample operator[](std::uint32_t sample) const;

 private:
  static constexpr std::uint32_t kTabulated = 16;

  std::uint64_t key_;
  std::uint32_t count_, columns_, rows_;
  double per_row_, per_column_, per_count_;  ///< one over the number
  Permutation order_, column_, sub_column_;
  bool tabulated_;
  /// The permutations, as tables, if columns and rows are few.
  std::uint8_t column_at_[kTabulated], sub_column_at_[kTabulated];
};

/// One point of StratifiedPattern(count, key).
inline SquareSample stratified_sample(std::uint32_t sample, std::uint32_t count, std::uint64_t key) {
  return StratifiedPattern(count, key, false)[sample];
}

/// The key of the pattern for dimension `dimension` of the pixel whose random numbers have the key `pixel`.
std::uint64_t pattern_key(std::uint64_t pixel, std::uint32_t dimension);

/// A unit vector about the unit normal `n` with density cos(angle) / pi.
Vec3f cosine_direction(const Vec3f& n, const SquareSample& s);

}  // namespace oktett
