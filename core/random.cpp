#include "core/random.h"

#include <bit>

namespace oktett {

static constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ull;

std::uint64_t pixel_key(std::uint32_t seed, std::uint64_t pixel) {
  return mix_bits(mix_bits(seed + kGolden) + (pixel + 1) * kGolden);
}

std::uint64_t random_bits(std::uint64_t key, std::uint32_t sample, std::uint32_t dimension) {
  const std::uint64_t counter = (static_cast<std::uint64_t>(sample) << 32) | dimension;
  return mix_bits(key + (counter + 1) * kGolden);
}

float random_float(std::uint64_t key, std::uint32_t sample, std::uint32_t dimension) {
  return static_cast<float>(random_bits(key, sample, dimension) >> 40) * 0x1p-24f;
}

std::uint32_t permute(std::uint32_t i, std::uint32_t n, std::uint64_t key) {
  if (n < 2) return 0;
  const int width = std::bit_width(n - 1);
  const std::uint32_t mask = width == 32 ? 0xffffffffu : (1u << width) - 1;
  const int shift = width > 2 ? width / 2 : 1;
  std::uint64_t round[3];
  for (std::uint64_t r = 0; r < 3; ++r) round[r] = mix_bits(key + (r + 1) * kGolden);
  // Each step is a bijection on `width` bits; walking its cycle until it returns to the range restricts it to
  // n numbers.
  do {
    for (const std::uint64_t bits : round) {
      i = (i + static_cast<std::uint32_t>(bits)) & mask;
      i = (i * (static_cast<std::uint32_t>(bits >> 32) | 1u)) & mask;
      i ^= i >> shift;
    }
  } while (i >= n);
  // A random turn makes every target equally likely for each i, which so few rounds do not for small n.
  const std::uint64_t turn = (mix_bits(key) >> 32) * n >> 32;
  return static_cast<std::uint32_t>((i + turn) % n);
}

}  // namespace oktett
