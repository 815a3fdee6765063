#include "accel/build/morton.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/chunks.h"

namespace oktett {
namespace {

constexpr std::size_t kLeastKeys = 1u << 13, kMostKeyChunks = 32;
constexpr int kDigit = 11;  ///< bits sorted by in one pass
constexpr std::uint32_t kDigits = 1u << kDigit;

/// Bits 0-6 to every third place.
std::uint32_t spread(std::uint32_t v) {
  v = (v | v << 8) & 0x0000700fu;
  v = (v | v << 4) & 0x000430c3u;
  return (v | v << 2) & 0x00049249u;
}

/// One pass of a stable counting sort: each chunk counts its digits, then moves its keys to places of its
/// own.
void sort_pass(const Chunks& chunks, bool parallel, const CellKey* from, int shift, CellKey* to) {
  std::vector<std::uint32_t> next(chunks.count * kDigits, 0);
  const auto digit = [&](const CellKey& k) { return k.cell >> shift & (kDigits - 1); };
  chunks.each(parallel, [&](std::size_t c, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) ++next[c * kDigits + digit(from[i])];
  });
  std::uint32_t sum = 0;
  for (std::uint32_t d = 0; d < kDigits; ++d)
    for (std::size_t c = 0; c < chunks.count; ++c) {
      const std::uint32_t n = next[c * kDigits + d];
      next[c * kDigits + d] = sum;
      sum += n;
    }
  chunks.each(parallel, [&](std::size_t c, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) to[next[c * kDigits + digit(from[i])]++] = from[i];
  });
}

}  // namespace

void sort_by_cells(const BuildArrays& arrays, const Centers& centers, bool parallel) {
  const std::size_t count = arrays.count;
  const Chunks chunks(count, kLeastKeys, kMostKeyChunks);
  const PrimRef* const refs = arrays.refs;
  CellKey* const keys = arrays.keys;
  constexpr float kPerAxis = 1 << kMortonBits / 3;
  float extent = 0;
  for (int k = 0; k < 3; ++k) extent = std::max(extent, centers.hi[k] - centers.lo[k]);
  float scale = kPerAxis / extent;
  if (!(extent > 0 && std::isfinite(extent) && std::isfinite(scale))) scale = 0;
  arrays.populate(keys, count, parallel), arrays.populate(arrays.more_keys, count, parallel);
  chunks.each(parallel, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::uint32_t cell = 0;
      for (int k = 0; k < 3; ++k) {
        const float c = (refs[i].hi[k] - refs[i].negative_lo[k] - centers.lo[k]) * scale;
        // NaN, from infinite bounds, is cell 0.
        const float inside = c > 0 ? std::min(c, kPerAxis - 1) : 0;
        cell |= spread(static_cast<std::uint32_t>(inside)) << (2 - k);
      }
      keys[i] = {cell, static_cast<std::uint32_t>(i)};
    }
  });
  sort_pass(chunks, parallel, keys, 0, arrays.more_keys);
  sort_pass(chunks, parallel, arrays.more_keys, kDigit, keys);
  arrays.populate(arrays.cells, count, parallel);
  chunks.each(parallel, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      arrays.more_refs[i] = refs[keys[i].place], arrays.cells[i] = keys[i].cell;
  });
}

}  // namespace oktett
