#include "accel/build/morton.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "accel/build/populate.h"

namespace oktett {
namespace {

constexpr std::size_t kMinChunk = 1u << 14, kMaxChunks = 32;
constexpr int kDigit = 11;  ///< bits sorted by in one pass
constexpr std::uint32_t kDigits = 1u << kDigit;

/// Bits 0-6 to every third place.
std::uint32_t spread(std::uint32_t v) {
  v = (v | v << 8) & 0x0000700fu;
  v = (v | v << 4) & 0x000430c3u;
  return (v | v << 2) & 0x00049249u;
}

/// A reference's cell and its place.
struct Key {
  std::uint32_t cell, place;
};

struct Chunks {
  std::size_t total, size, count;
  bool parallel;
  template <class Body>
  void each(Body&& body) const {
    const auto chunk = [&](std::size_t c) { body(c, c * size, std::min((c + 1) * size, total)); };
    if (parallel && count > 1)
      tbb::parallel_for(std::size_t{0}, count, chunk);
    else
      for (std::size_t c = 0; c < count; ++c) chunk(c);
  }
};

/// One pass of a stable counting sort: each chunk counts its digits, then moves its keys to places of its
/// own.
void sort_pass(const Chunks& chunks, const Column<Key>& from, int shift, Column<Key>& to) {
  std::vector<std::uint32_t> next(chunks.count * kDigits, 0);
  const auto digit = [&](const Key& k) { return k.cell >> shift & (kDigits - 1); };
  chunks.each([&](std::size_t c, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) ++next[c * kDigits + digit(from[i])];
  });
  std::uint32_t sum = 0;
  for (std::uint32_t d = 0; d < kDigits; ++d)
    for (std::size_t c = 0; c < chunks.count; ++c) {
      const std::uint32_t n = next[c * kDigits + d];
      next[c * kDigits + d] = sum;
      sum += n;
    }
  chunks.each([&](std::size_t c, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) to[next[c * kDigits + digit(from[i])]++] = from[i];
  });
}

}  // namespace

void sort_by_cells(const Column<PrimRef>& refs, const Centers& centers, bool parallel,
                   Column<PrimRef>& sorted, Column<std::uint32_t>& cells) {
  const std::size_t n = refs.size(), size = std::max(kMinChunk, (n + kMaxChunks - 1) / kMaxChunks);
  const Chunks chunks{n, size, (n + size - 1) / size, parallel};
  constexpr float kPerAxis = 1 << kMortonBits / 3;
  float extent = 0;
  for (int k = 0; k < 3; ++k) extent = std::max(extent, centers.hi[k] - centers.lo[k]);
  float scale = kPerAxis / extent;
  if (!(extent > 0 && std::isfinite(extent) && std::isfinite(scale))) scale = 0;
  Column<Key> keys(n), other(n);
  populate(keys.data(), n, parallel), populate(other.data(), n, parallel);
  chunks.each([&](std::size_t, std::size_t begin, std::size_t end) {
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
  sort_pass(chunks, keys, 0, other);
  sort_pass(chunks, other, kDigit, keys);
  sorted.resize_uninitialized(n), cells.resize_uninitialized(n);
  populate(cells.data(), n, parallel);
  chunks.each([&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) sorted[i] = refs[keys[i].place], cells[i] = keys[i].cell;
  });
}

}  // namespace oktett
