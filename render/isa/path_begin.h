#pragma once
/// \file What path tracing needs of hits before it looks at their materials: directions, normals and random
/// numbers.

#include "core/simd_memory.h"
#include "core/simd_native.h"
#include "render/sampling/owen_sobol.h"
#include "render/shading_lanes.h"
#include "render/transport/path_block.h"
#include "render/transport/sample_dimensions.h"

namespace oktett {

/// sobol_point for all hits, as whole numbers. Plain loops, which compilers turn into vector code.
template <class A>
void sobol_words(const PathBlock& c, std::uint32_t dimension, std::uint32_t* x, std::uint32_t* y) {
  std::uint64_t key[PathBlock::kMost];
  std::uint32_t number[PathBlock::kMost];
  const std::uint64_t step = (std::uint64_t{dimension} + 1) * kGoldenBits;
  for (std::size_t i = 0; i < PathBlock::kMost; ++i) key[i] = mix_bits(c.key[i] + step);
  for (std::size_t i = 0; i < PathBlock::kMost; ++i) number[i] = shuffled_sample(c.number[i], key[i]);
  for (std::size_t i = 0; i < PathBlock::kMost; ++i)
    x[i] = reversed_bits(scrambled_upwards(number[i], static_cast<std::uint32_t>(key[i])));
  if (y == nullptr) return;
  for (std::size_t i = 0; i < PathBlock::kMost; ++i)
    y[i] =
        reversed_bits(scrambled_upwards(pascal_product(number[i]), static_cast<std::uint32_t>(key[i] >> 32)));
}

template <class A>
void sobol_points_of(const PathBlock& c, std::uint32_t dimension, double* x, double* y) {
  std::uint32_t words[2][PathBlock::kMost];
  sobol_words<A>(c, dimension, words[0], y != nullptr ? words[1] : nullptr);
  for (std::size_t i = 0; i < PathBlock::kMost; ++i) x[i] = words[0][i] * 0x1p-32;
  if (y == nullptr) return;
  for (std::size_t i = 0; i < PathBlock::kMost; ++i) y[i] = words[1][i] * 0x1p-32;
}

template <class A>
void sobol_numbers_of(const PathBlock& c, std::uint32_t dimension, float* x) {
  std::uint32_t words[PathBlock::kMost];
  sobol_words<A>(c, dimension, words, nullptr);
  for (std::size_t i = 0; i < PathBlock::kMost; ++i)
    x[i] = static_cast<float>(static_cast<std::int32_t>(words[i] >> 8)) * 0x1p-24f;
}

template <class A>
void begin_path_code(const InteractionBlock& s, const PathRays& rays, unsigned level, PathBlock& c) {
  using F = Simd<float, kDoubleLanes<A>, A>;
  c.behind = 0;
  for (std::size_t i = 0; i < c.count; i += F::kWidth) {
    const PickedLanes<F> ray(c.ray + i);
    const auto load = [&](const float* const(&column)[3]) {
      return Vec3<F>{ray.load(column[0]), ray.load(column[1]), ray.load(column[2])};
    };
    const auto row = [&](const float(&column)[3][PathBlock::kMost]) {
      return Vec3<F>{F::load(column[0] + i), F::load(column[1] + i), F::load(column[2] + i)};
    };
    const auto put = [&](const Vec3<F>& v, float(&column)[3][PathBlock::kMost]) {
      v.x.store(column[0] + i), v.y.store(column[1] + i), v.z.store(column[2] + i);
    };
    const Vec3<F> direction = load(rays.direction);
    Vec3<F> ng, ns;
    const auto behind = face_ray(direction, row(s.geometric_normal), row(s.shading_normal), ng, ns);
    c.behind |= std::uint64_t{bits(behind)} << i;
    put(direction, c.direction), put(load(rays.throughput), c.throughput), put(ng, c.ng), put(ns, c.ns);
  }
  const auto of = [&](Decision decision) { return dimension(decision, level); };
  sobol_numbers_of<A>(c, of(Decision::lobe), c.lobe);
  sobol_points_of<A>(c, of(Decision::direction), c.direction_x, c.direction_y);
  if (c.asks_lights) {
    sobol_points_of<A>(c, of(Decision::light), c.light, nullptr);
    sobol_points_of<A>(c, of(Decision::light_place), c.light_x, c.light_y);
  }
  // A path has no more bounces than its wavefront.
  if (level + 1 > kSureBounces) sobol_numbers_of<A>(c, of(Decision::roulette), c.roulette);
}

}  // namespace oktett
