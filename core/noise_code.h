#pragma once
/// \file The code of noise_at_places (core/noise_places.h) for one instruction set: the arithmetic of
/// core/noise.cpp in lanes.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/isa_select.h"
#include "core/noise.h"
#include "core/noise_steps.h"
#include "core/platform.h"
#include "core/random.h"

namespace oktett {

/// Vectors of the compiler, which knows products of 64-bit integers in each instruction set.
template <std::size_t W>
struct NoiseVectors {
  using Doubles [[gnu::vector_size(8 * W)]] = double;
  using Integers [[gnu::vector_size(8 * W)]] = std::uint64_t;
};

/// W places in lanes.
template <std::size_t W>
struct NoiseLanes {
  using D = typename NoiseVectors<W>::Doubles;
  using U = typename NoiseVectors<W>::Integers;

  /// mix_bits(from + coordinate + kGoldenBits).
  static OKTETT_INLINE U next(const U& from, const U& coordinate) {
    U x = from + coordinate + kGoldenBits;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
  }
  /// The product of the gradient that `bits` chooses with (x, y, z).
  static OKTETT_INLINE D edge_product(const U& bits, const D& x, const D& y, const D& z) {
    const U high = bits >> 32;
    // A third, for numbers of 32 bits.
    const U k = high - 3 * ((high * 0xaaaaaaabull) >> 33);
    const U a = std::bit_cast<U>(x), b = std::bit_cast<U>(y), c = std::bit_cast<U>(z);
    const U first = k == 0 ? a : k == 1 ? b : c, second = k == 0 ? b : k == 1 ? c : a;
    return std::bit_cast<D>(first ^ bits << 63) + std::bit_cast<D>(second ^ (bits >> 1) << 63);
  }

  /// All coordinates are less than 2^51 in size.
  static OKTETT_INLINE D noise(const D (&p)[3]) {
    constexpr double kWhole = 0x1.8p52;
    U cell[3];
    D f[3], t[3];
    for (int k = 0; k < 3; ++k) {
      // Sums with kWhole are integers, which the bits hold as they are.
      const D sum = p[k] + kWhole, nearest = sum - kWhole;
      const U above = std::bit_cast<U>(nearest > p[k]);  // -1 where it is
      const D floor = nearest - std::bit_cast<D>(above & std::bit_cast<std::uint64_t>(1.0));
      cell[k] = std::bit_cast<U>(sum) - std::bit_cast<std::uint64_t>(kWhole) + above;
      // Not -0.
      f[k] = (p[k] - floor) + 0.0;
      t[k] = noise_steps::fade<D>(f[k]);
    }
    U of_x[2], of_xy[4];
    for (std::uint64_t i = 0; i < 2; ++i) of_x[i] = next(U{}, cell[0] + i);
    for (std::uint64_t i = 0; i < 4; ++i) of_xy[i] = next(of_x[i & 1], cell[1] + (i >> 1));
    const D one_less[3] = {f[0] - 1, f[1] - 1, f[2] - 1};
    D c[8];
    for (std::uint64_t i = 0; i < 8; ++i)
      c[i] = edge_product(next(of_xy[i & 3], cell[2] + (i >> 2)), (i & 1) != 0 ? one_less[0] : f[0],
                          (i & 2) != 0 ? one_less[1] : f[1], (i & 4) != 0 ? one_less[2] : f[2]);
    return noise_steps::between<D>(c, t);
  }
};

/// Places that a set takes at once: as many as its registers hold.
template <class A>
inline constexpr int kNoiseLanes = 2;
template <>
inline constexpr int kNoiseLanes<Avx512Isa> = 8;
template <>
inline constexpr int kNoiseLanes<Avx2Isa> = 4;

template <class A>
void noise_code(const Vec3d* places, std::size_t count, double* values) {
  constexpr std::size_t W = kNoiseLanes<A>;
  for (std::size_t begin = 0; begin < count; begin += W) {
    const std::size_t n = std::min(W, count - begin);
    typename NoiseLanes<W>::D p[3]{};
    bool far = std::is_same_v<A, ScalarIsa>;
    for (std::size_t i = 0; i < n; ++i)
      for (int k = 0; k < 3; ++k) {
        p[k][i] = places[begin + i][k];
        far |= !(std::abs(places[begin + i][k]) < 0x1p51);
      }
    if (far) {
      for (std::size_t i = 0; i < n; ++i) values[begin + i] = gradient_noise(places[begin + i]);
      continue;
    }
    const auto noise = NoiseLanes<W>::noise(p);
    for (std::size_t i = 0; i < n; ++i) values[begin + i] = noise[i];
  }
}

}  // namespace oktett
