#pragma once
/// \file Sample points spread evenly over the unit square: the first two dimensions of Sobol's sequence,
/// Owen-scrambled (Burley 2020, JCGT 9(4)). Each point is computed from its number alone.

#include <cstdint>

#include "core/random.h"
#include "render/sampling/warp.h"

namespace oktett {

/// The order of the 32 bits reversed.
constexpr std::uint32_t reversed_bits(std::uint32_t x) {
  x = x >> 16 | x << 16;
  x = (x & 0xff00ff00u) >> 8 | (x & 0x00ff00ffu) << 8;
  x = (x & 0xf0f0f0f0u) >> 4 | (x & 0x0f0f0f0fu) << 4;
  x = (x & 0xccccccccu) >> 2 | (x & 0x33333333u) << 2;
  return (x & 0xaaaaaaaau) >> 1 | (x & 0x55555555u) << 1;
}

/// A bijection on 32 bits in which each bit changes only bits above itself. On reversed numbers it is an Owen
/// scrambling: it permutes the halves of the unit interval, their halves, and so on. The hash is Laine's and
/// Karras's (2011) with the constants of Vegdahl (2021, "Building a better LK hash").
constexpr std::uint32_t scrambled_upwards(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= seed >> 16 | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/// Bit k of the result is the sum modulo 2 of the bits j of x for which the binomial coefficient of j and k
/// is odd: the generator matrix of the second dimension of Sobol's sequence.
constexpr std::uint32_t pascal_product(std::uint32_t x) {
  x ^= x >> 16 & 0x0000ffffu;
  x ^= x >> 8 & 0x00ff00ffu;
  x ^= x >> 4 & 0x0f0f0f0fu;
  x ^= x >> 2 & 0x33333333u;
  return x ^ (x >> 1 & 0x55555555u);
}

/// The place of `sample` in a random order that keeps blocks of 2^k consecutive samples together. Orders of
/// different keys are independent, so the points of two sequences do not belong together.
constexpr std::uint32_t shuffled_sample(std::uint32_t sample, std::uint64_t key) {
  const auto seed = static_cast<std::uint32_t>(mix_bits(key + kGoldenBits));
  return reversed_bits(scrambled_upwards(reversed_bits(sample), seed));
}

/// Point `sample` of the sequence that `key` chooses. The points k n ... k n + n - 1, where n = 2^a 2^b,
/// stand one each in the cells of a grid of 2^a by 2^b.
inline SquareSample sobol_point(std::uint32_t sample, std::uint64_t key) {
  const std::uint32_t number = shuffled_sample(sample, key);
  const std::uint32_t x = reversed_bits(scrambled_upwards(number, static_cast<std::uint32_t>(key)));
  const std::uint32_t y =
      reversed_bits(scrambled_upwards(pascal_product(number), static_cast<std::uint32_t>(key >> 32)));
  return {x * 0x1p-32, y * 0x1p-32};
}

/// The x of sobol_point, rounded down to a multiple of 2^-24.
inline float sobol_number(std::uint32_t sample, std::uint64_t key) {
  const std::uint32_t x =
      reversed_bits(scrambled_upwards(shuffled_sample(sample, key), static_cast<std::uint32_t>(key)));
  // As a signed 32-bit integer, which processors convert in one instruction.
  return static_cast<float>(static_cast<std::int32_t>(x >> 8)) * 0x1p-24f;
}

/// The key of the sequence for decision `dimension` of the pixel whose random numbers have the key `pixel`.
inline std::uint64_t sequence_key(std::uint64_t pixel, std::uint32_t dimension) {
  return mix_bits(pixel + (std::uint64_t{dimension} + 1) * kGoldenBits);
}

}  // namespace oktett
