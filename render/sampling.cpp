#include "render/sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"
#include "core/random.h"

namespace oktett {

static constexpr double kBelowOne = 1 - 0x1p-53;

SquareSample stratified_sample(std::uint32_t sample, std::uint32_t count, std::uint64_t key) {
  if (count <= 1) return {0.5, 0.5};
  const auto columns = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(count)));
  const std::uint32_t rows = (count + columns - 1) / columns;
  const std::uint32_t s = permute(sample, count, key);
  const std::uint32_t column = permute(s % columns, columns, key ^ 0x68bc21eb);
  const std::uint32_t sub_column = permute(s / columns, rows, key ^ 0x02e5be93);
  const double jitter_x = random_float(key, s, 0), jitter_y = random_float(key, s, 1);
  return {std::min(kBelowOne, (column + (sub_column + jitter_x) / rows) / columns),
          std::min(kBelowOne, (s + jitter_y) / count)};
}

std::uint64_t pattern_key(std::uint64_t pixel, std::uint32_t dimension) {
  // No sample has this number, so patterns share no random bits with the samples themselves.
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
