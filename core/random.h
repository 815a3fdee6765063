#pragma once
/// \file Random numbers without state: each is a function of pixel, sample and dimension, so a picture does
/// not depend on the order in which its pixels are computed.

#include <cstdint>

namespace oktett {

/// A bijection on 64 bits that spreads every input bit over all output bits: the finaliser of SplitMix64
/// (Steele, Lea, Flood 2014) with Stafford's constants "Mix13".
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// 2^64 divided by the golden ratio: its multiples modulo 2^64 are spread evenly.
inline constexpr std::uint64_t kGoldenBits = 0x9e3779b97f4a7c15ull;

/// The key of all random numbers of one pixel. `pixel` counts through the full frame, so a crop shows the
/// same noise.
inline std::uint64_t pixel_key(std::uint32_t seed, std::uint64_t pixel) {
  return mix_bits(mix_bits(seed + kGoldenBits) + (pixel + 1) * kGoldenBits);
}

/// 64 random bits for dimension `dimension` of sample `sample` under `key`.
inline std::uint64_t random_bits(std::uint64_t key, std::uint32_t sample, std::uint32_t dimension) {
  const std::uint64_t counter = (static_cast<std::uint64_t>(sample) << 32) | dimension;
  return mix_bits(key + (counter + 1) * kGoldenBits);
}

/// Uniform in [0, 1): a multiple of 2^-24.
inline float random_float(std::uint64_t key, std::uint32_t sample, std::uint32_t dimension) {
  // As a signed 32-bit integer, which processors convert in one instruction.
  return static_cast<float>(static_cast<std::int32_t>(random_bits(key, sample, dimension) >> 40)) * 0x1p-24f;
}

}  // namespace oktett
