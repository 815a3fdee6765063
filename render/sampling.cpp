#include "render/sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"

namespace oktett {

static constexpr double kBelowOne = 1 - 0x1p-53;

static std::uint32_t columns_for(std::uint32_t count) {
  return count <= 1 ? 1 : static_cast<std::uint32_t>(std::sqrt(static_cast<double>(count)));
}

StratifiedPattern::StratifiedPattern(std::uint32_t count, std::uint64_t key, bool whole)
    : key_(key),
      count_(count),
      columns_(columns_for(count)),
      rows_((count + columns_ - 1) / columns_),
      per_row_(1.0 / rows_),
      per_column_(1.0 / columns_),
      per_count_(1.0 / std::max(count, 1u)),
      order_(count, key),
      column_(columns_, key ^ 0x68bc21eb),
      sub_column_(rows_, key ^ 0x02e5be93),
      tabulated_(whole && rows_ <= kTabulated) {
  if (!tabulated_) return;
  for (std::uint32_t i = 0; i < columns_; ++i) column_at_[i] = static_cast<std::uint8_t>(column_(i));
  for (std::uint32_t i = 0; i < rows_; ++i) sub_column_at_[i] = static_cast<std::uint8_t>(sub_column_(i));
}

SquareSample StratifiedPattern::operator[](std::uint32_t sample) const {
  if (count_ <= 1) return {0.5, 0.5};
  const std::uint32_t s = order_(sample);
  const std::uint32_t cell_row = s / columns_, cell_column = s - cell_row * columns_;
  const std::uint32_t column = tabulated_ ? column_at_[cell_column] : column_(cell_column);
  const std::uint32_t sub_column = tabulated_ ? sub_column_at_[cell_row] : sub_column_(cell_row);
  const double jitter_x = random_float(key_, s, 0), jitter_y = random_float(key_, s, 1);
  return {std::min(kBelowOne, (column + (sub_column + jitter_x) * per_row_) * per_column_),
          std::min(kBelowOne, (s + jitter_y) * per_count_)};
}

std::uint64_t pattern_key(std::uint64_t pixel, std::uint32_t dimension) {
  // No sample has this number, so patterns share no random bits with samples.
  return random_bits(pixel, 0xffffffffu, dimension);
}

Vec3f cosine_direction(const Vec3f& n, const SquareSample& s) {
  const double radius = std::sqrt(s.x), angle = 2 * std::numbers::pi * s.y;
  const auto x = static_cast<float>(radius * portable::cos(angle));
  const auto y = static_cast<float>(radius * portable::sin(angle));
  const auto z = static_cast<float>(std::sqrt(1 - s.x));
  Vec3f tangent, bitangent;
  make_basis(n, tangent, bitangent);
  return normalize(tangent * x + bitangent * y + n * z);
}

}  // namespace oktett
