#include "render/look/coarse_mesh.h"

#include <tbb/combinable.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <vector>

#include "core/box.h"
#include "core/parallel.h"

namespace oktett {
namespace {

/// Cells of a grid, those with vertices numbered in their order.
class Cells {
 public:
  Cells(const TriangleMesh& mesh, int cells) : mesh_(mesh), most_(std::clamp(cells, 1, 1024)) {
    tbb::combinable<Box> boxes;
    in_parts(mesh.positions.size(), kPart, [&](std::size_t begin, std::size_t end) {
      Box& box = boxes.local();
      for (std::size_t i = begin; i < end; ++i)
        if (is_finite(mesh.positions[i])) box.grow(mesh.positions[i]);
    });
    Box box;
    boxes.combine_each([&](const Box& b) { box.grow(b); });
    if (box.empty()) return;
    lo_ = Vec3d(box.lo);
    const Vec3d extent = Vec3d(box.hi) - lo_;
    scale_ = most_ / std::max(max_component(extent), 1e-300);
    for (int k = 0; k < 3; ++k)
      size_[k] = static_cast<std::size_t>(std::clamp(std::floor(extent[k] * scale_), 0.0, most_ - 1.0)) + 1;
    mark();
  }

  /// The first vertices of all cells that have some.
  const std::vector<std::uint32_t>& vertices() const { return first_; }

  /// The number of the cell of a vertex, or kNoId if that is not finite.
  std::uint32_t number_of(std::uint32_t vertex) const {
    const Vec3f& p = mesh_.positions[vertex];
    if (!is_finite(p)) return kNoId;
    const std::size_t cell = cell_of(p), word = cell / 64;
    const std::uint64_t before = used_[word] & ((std::uint64_t{1} << cell % 64) - 1);
    return rank_[word] + static_cast<std::uint32_t>(std::popcount(before));
  }

 private:
  static constexpr std::size_t kPart = std::size_t{1} << 16;

  std::size_t cell_of(const Vec3f& p) const {
    std::size_t at[3];
    for (int k = 0; k < 3; ++k) {
      const double c = (static_cast<double>(p[k]) - lo_[k]) * scale_;
      at[k] = std::min(static_cast<std::size_t>(std::max(c, 0.0)), size_[k] - 1);
    }
    return (at[0] * size_[1] + at[1]) * size_[2] + at[2];
  }

  void mark() {
    const std::size_t words = size_[0] * size_[1] * size_[2] / 64 + 1;
    used_.resize(words), rank_.resize(words);
    in_parts(mesh_.positions.size(), kPart, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (!is_finite(mesh_.positions[i])) continue;
        const std::size_t cell = cell_of(mesh_.positions[i]);
        const std::uint64_t bit = std::uint64_t{1} << cell % 64;
        std::atomic_ref<std::uint64_t> word(used_[cell / 64]);
        if ((word.load(std::memory_order_relaxed) & bit) == 0) word.fetch_or(bit, std::memory_order_relaxed);
      }
    });
    std::uint32_t count = 0;
    for (std::size_t w = 0; w < words; ++w) {
      rank_[w] = count;
      count += static_cast<std::uint32_t>(std::popcount(used_[w]));
    }
    first_.assign(count, kNoId);
    in_parts(mesh_.positions.size(), kPart, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const auto vertex = static_cast<std::uint32_t>(i);
        const std::uint32_t number = number_of(vertex);
        if (number == kNoId) continue;
        std::atomic_ref<std::uint32_t> first(first_[number]);
        std::uint32_t known = first.load(std::memory_order_relaxed);
        while (vertex < known && !first.compare_exchange_weak(known, vertex, std::memory_order_relaxed)) {}
      }
    });
  }

  const TriangleMesh& mesh_;
  const int most_;
  Vec3d lo_{};
  double scale_ = 0;
  std::size_t size_[3] = {1, 1, 1};
  std::vector<std::uint64_t> used_;   ///< a bit for each cell
  std::vector<std::uint32_t> rank_;   ///< used cells before each word
  std::vector<std::uint32_t> first_;  ///< of each used cell
};

}  // namespace

TriangleMesh coarse_copy(const TriangleMesh& mesh, int cells) {
  const Cells grid(mesh, cells);
  TriangleMesh coarse;
  coarse.positions.resize_uninitialized(grid.vertices().size());
  for (std::size_t i = 0; i < coarse.positions.size(); ++i)
    coarse.positions[i] = mesh.positions[grid.vertices()[i]];
  const Chunks chunks(mesh.triangle_count(), std::size_t{1} << 16);
  std::vector<std::vector<std::uint32_t>> parts(chunks.count);
  chunks.each(true, [&](std::size_t c, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      std::uint32_t v[3];
      for (std::size_t k = 0; k < 3; ++k) v[k] = grid.number_of(mesh.indices[3 * t + k]);
      if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
      if (v[0] == kNoId || v[1] == kNoId || v[2] == kNoId) continue;
      parts[c].insert(parts[c].end(), v, v + 3);
    }
  });
  std::size_t count = 0;
  for (const auto& part : parts) count += part.size();
  coarse.indices.resize_uninitialized(count);
  std::uint32_t* out = coarse.indices.begin();
  for (const auto& part : parts) out = std::copy(part.begin(), part.end(), out);
  return coarse;
}

}  // namespace oktett
