#pragma once
/// \file Passes over the columns of a wavefront, for one instruction set.

#include "core/simd_memory.h"
#include "core/simd_order.h"
#include "render/isa/shading.h"
#include "render/transport/ray_queue.h"

namespace oktett {

// Columns are padded, so the last group of lanes may reach beyond their sizes where each lane stays in its
// place.

template <class A>
void split_rays_code(const Column<std::uint32_t>& item, const ColorColumn& throughput,
                     const Color& background, ColorColumn& radiance, Column<std::uint32_t>& hit_rays) {
  using F = ShadingLanes<A>;
  using I = Simd<std::int32_t, F::kWidth, A>;
  const std::size_t count = item.size();
  radiance.resize_uninitialized(count);
  // A group writes 16 numbers, whatever it has found.
  hit_rays.resize_uninitialized(count + 16);
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; i += F::kWidth) {
    const auto missed = I::load(reinterpret_cast<const std::int32_t*>(item.data() + i)) == I(-1);
    const auto bright = mask_cast<float>(missed);
    for (int k = 0; k < 3; ++k) {
      const F light = F::load(throughput.part[k].data() + i) * F(background[k]);
      select(bright, light, F(0.0f)).store(radiance.part[k].data() + i);
    }
    const unsigned hits = ~bits(missed) & lanes_before<F>(count, i);
    auto* to = reinterpret_cast<std::int32_t*>(hit_rays.data() + found);
    found += static_cast<std::size_t>(store_set_bits<A>(hits, static_cast<std::int32_t>(i), to));
  }
  hit_rays.resize_uninitialized(found);
}

template <class A>
void block_light_code(const Column<std::uint8_t>& blocked, ColorColumn& light) {
  const std::size_t count = blocked.size();
  for (Column<float>& part : light.part)
    for (std::size_t i = 0; i < count; ++i) part[i] = blocked[i] != 0 ? 0.0f : part[i];
}

template <class A>
void add_colors_code(const ColorColumn& from, const Column<std::uint32_t>& entry, ColorColumn& to) {
  using F = ShadingLanes<A>;
  constexpr unsigned kAll = (1u << F::kWidth) - 1;
  const F zero(0.0f);
  const std::size_t count = entry.size();
  std::size_t i = 0;
  for (; i + F::kWidth <= count; i += F::kWidth) {
    const auto part = [&](int k) { return F::load(from.part[k].data() + i); };
    const F r = part(0), g = part(1), b = part(2);
    const unsigned bright = ~bits((r == zero) & (g == zero) & (b == zero)) & kAll;
    if (bright == 0) continue;
    const PickedLanes<F> at(entry.data() + i);
    at.add(r, to.part[0].data(), bright), at.add(g, to.part[1].data(), bright);
    at.add(b, to.part[2].data(), bright);
  }
  for (; i < count; ++i)
    if (!is_black(from[i])) to.add(entry[i], from[i]);
}

template <class A>
bool all_finite_code(const float* column, std::size_t count) {
  using F = ShadingLanes<A>;
  // x * 0 is 0 for finite x and NaN for all others.
  const F zero(0.0f);
  F sum = zero;
  float rest = 0;
  std::size_t i = 0;
  for (; i + F::kWidth <= count; i += F::kWidth) sum = sum + F::load(column + i) * zero;
  for (; i < count; ++i) rest += column[i] * 0;
  return none(~(sum == zero)) && rest == 0;
}

}  // namespace oktett
