#include "core/random.h"

#include <bit>

namespace oktett {

Permutation::Permutation(std::uint32_t n, std::uint64_t key) : n_(n) {
  if (n < 2) return;
  const int width = std::bit_width(n - 1);
  mask_ = width == 32 ? 0xffffffffu : (1u << width) - 1;
  shift_ = width > 2 ? width / 2 : 1;
  for (std::uint64_t r = 0; r < 3; ++r) round_[r] = mix_bits(key + (r + 1) * kGoldenBits);
  // A random rotation makes every target equally likely for each i; so few rounds alone do not, for small n.
  turn_ = static_cast<std::uint32_t>((mix_bits(key) >> 32) * n >> 32);
}

}  // namespace oktett
