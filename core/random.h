#pragma once
/// \file Random numbers without state: each is a function of its place, so that a picture does not depend on
/// the order in which its pixels are computed.

#include <cstdint>

namespace oktett {

/// A bijection on 64 bits that spreads every input bit over all output bits: the finaliser of SplitMix64
/// (Steele, Lea, Flood 2014) with Stafford's constants "Mix13".
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// The key of all random numbers of one pixel. `pixel` counts through the full frame, so a crop shows the
/// same noise.
std::uint64_t pixel_key(std::uint32_t seed, std::uint64_t pixel);

/// 64 random bits for dimension `dimension` of sample `sample` under `key`.
std::uint64_t random_bits(std::uint64_t key, std::uint32_t sample, std::uint32_t dimension);

/// Uniform in [0, 1): a multiple of 2^-24.
float random_float(std::uint64_t key, std::uint32_t sample, std::uint32_t dimension);

/// Where a random permutation of 0 ... n-1, chosen by `key`, sends `i`. `i` < `n`.
std::uint32_t permute(std::uint32_t i, std::uint32_t n, std::uint64_t key);

}  // namespace oktett
