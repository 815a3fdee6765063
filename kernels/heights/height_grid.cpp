#include "kernels/heights/height_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/error.h"
#include "kernels/heights/make_height_grid.h"

namespace oktett {

HeightGrid::HeightGrid(std::uint32_t columns, std::uint32_t rows, HeightInterpolation interpolation)
    : columns_(columns),
      rows_(rows),
      interpolation_(interpolation),
      tile_row_(std::size_t{tiles(columns)} * kTileSamples) {}

std::shared_ptr<const HeightGrid> HeightGrid::from_words(std::uint32_t columns, std::uint32_t rows,
                                                         Column<std::uint16_t> words,
                                                         HeightInterpolation interpolation) {
  std::shared_ptr<HeightGrid> grid(new HeightGrid(columns, rows, interpolation));
  grid->words_ = grid->take(words);
  grid->word_data_ = grid->words_.data();
  grid->step_ = 1;
  grid->build_pyramid();
  return grid;
}

std::shared_ptr<const HeightGrid> HeightGrid::from_floats(std::uint32_t columns, std::uint32_t rows,
                                                          Column<float> floats,
                                                          HeightInterpolation interpolation) {
  std::shared_ptr<HeightGrid> grid(new HeightGrid(columns, rows, interpolation));
  grid->floats_ = grid->take(floats);
  grid->float_data_ = grid->floats_.data();
  // Rounded outwards to steps, for which there must be one to spare.
  grid->step_ = grid->greatest_ > grid->least_ ? (grid->greatest_ - grid->least_) / 65534 : 1;
  grid->build_pyramid();
  return grid;
}

/// The samples in tiles; notes the least and the greatest.
template <class T>
VirtualArray<T> HeightGrid::take(const Column<T>& samples) {
  const auto [lo, hi] = std::minmax_element(samples.begin(), samples.end());
  least_ = *lo, greatest_ = *hi;
  VirtualArray<T> stored(places());
  T* tile = stored.data();
  for (std::uint32_t z = 0; z < cells(rows_); z += kTile)
    for (std::uint32_t x = 0; x < cells(columns_); x += kTile, tile += kTileSamples)
      for (std::uint32_t j = 0; j < std::min(kRow, rows_ - z); ++j) {
        const T* const row = samples.data() + x + std::size_t{z + j} * columns_;
        std::copy_n(row, std::min(kRow, columns_ - x), tile + j * kRow);
      }
  return stored;
}

/// Of the samples that the surface over the cells of block (i, j) depends on: `nearest` has walls on the
/// borders of the block, up to the heights of the cells around it.
void HeightGrid::bound_cells(std::uint32_t i, std::uint32_t j, std::uint16_t& least,
                             std::uint16_t& greatest) const {
  const std::uint32_t ring = interpolation_ == HeightInterpolation::nearest ? 1 : 0;
  const auto begin = [&](std::uint32_t k) { return k * kBlock - std::min(ring, k * kBlock); };
  const auto end = [&](std::uint32_t k, std::uint32_t size) {
    return std::min(k * kBlock + kBlock + 1 + ring, size);
  };
  double lo = greatest_, hi = least_;
  for (std::uint32_t row = begin(j); row < end(j, rows_); ++row)
    for (std::uint32_t column = begin(i); column < end(i, columns_); ++column) {
      const double h = at(column, row);
      lo = std::min(lo, h), hi = std::max(hi, h);
    }
  const double below = std::floor((lo - least_) / step_), above = std::ceil((hi - least_) / step_);
  least = static_cast<std::uint16_t>(std::clamp(below, 0.0, 65535.0));
  greatest = static_cast<std::uint16_t>(std::clamp(above, 0.0, 65535.0));
}

void HeightGrid::build_pyramid() {
  const auto parts = [](std::uint32_t whole, std::uint32_t part) {
    return std::max((whole + part - 1) / part, 1u);
  };
  std::uint32_t side = kBlock, columns = parts(columns_ - 1, side), rows = parts(rows_ - 1, side);
  for (;;) {
    const std::uint32_t most = std::max(columns, rows);
    // With 4 x 4 blocks to a node, the next level would have 2 x 2 blocks at most; so it has up to 4 x 4.
    const std::uint32_t split = most > kBlock && most <= 2 * kBlock ? 2 : kBlock;
    const Level level{side, split, columns, rows, parts(columns, split), parts(rows, split), node_count_};
    level_[levels_++] = level;
    node_count_ += std::size_t{level.columns} * level.rows;
    side *= split, columns = level.columns, rows = level.rows;
    if (columns == 1 && rows == 1) break;
  }
  nodes_ = VirtualArray<HeightNode>(node_count_);
  node_data_ = nodes_.data();
  for (int k = 0; k < levels_; ++k) {
    const Level& level = level_[k];
    for (std::size_t n = 0; n < std::size_t{level.columns} * level.rows; ++n) {
      HeightNode& own = nodes_[level.first + n];
      std::fill_n(own.least, 16, std::uint16_t{65535});
      std::fill_n(own.greatest, 16, std::uint16_t{0});
    }
    for (std::uint32_t z = 0; z < level.block_rows; ++z)
      for (std::uint32_t x = 0; x < level.block_columns; ++x) {
        HeightNode& own =
            nodes_[level.first + x / level.split + std::size_t{z / level.split} * level.columns];
        const std::size_t b = x % level.split + std::size_t{kBlock} * (z % level.split);
        if (k == 0) {
          bound_cells(x, z, own.least[b], own.greatest[b]);
        } else {
          const HeightNode& below = node(k - 1, x, z);
          own.least[b] = *std::min_element(below.least, below.least + 16);
          own.greatest[b] = *std::max_element(below.greatest, below.greatest + 16);
        }
      }
  }
  const Level& last = level_[levels_ - 1];
  for (std::uint32_t k = 0; k < 16; ++k)
    for (std::uint32_t quadrant = 0; quadrant < 4; ++quadrant) {
      const std::uint32_t b = k ^ (3 * (quadrant & 1)) ^ (12 * (quadrant >> 1));
      const bool is_block = last.has_block(b % kBlock, b / kBlock);
      constexpr float kInf = std::numeric_limits<float>::infinity();
      roots_[quadrant].least[k] = is_block ? nodes_[last.first].least[b] : kInf;
      roots_[quadrant].greatest[k] = is_block ? nodes_[last.first].greatest[b] : -kInf;
    }
}

static void require_size(std::uint32_t columns, std::uint32_t rows, std::size_t samples) {
  const std::string size = std::to_string(columns) + " x " + std::to_string(rows);
  if (std::min(columns, rows) < 2 || std::max(columns, rows) > kMaxHeightSide ||
      std::size_t{columns} * rows > kMaxHeightSamples)
    throw Error("height grid of " + size + " samples; expected 2 to " + std::to_string(kMaxHeightSide) +
                " along a side and at most " + std::to_string(kMaxHeightSamples) + " in all");
  if (samples != std::size_t{columns} * rows)
    throw Error("height grid of " + size + " samples; found " + std::to_string(samples));
}

std::shared_ptr<const HeightGrid> make_height_grid(std::uint32_t columns, std::uint32_t rows,
                                                   Column<float> samples, HeightInterpolation interpolation) {
  require_size(columns, rows, samples.size());
  if (!std::all_of(samples.begin(), samples.end(), [](float s) { return std::isfinite(s); }))
    throw Error("height grid with samples that are not finite");
  return HeightGrid::from_floats(columns, rows, std::move(samples), interpolation);
}

std::shared_ptr<const HeightGrid> make_height_grid(std::uint32_t columns, std::uint32_t rows,
                                                   Column<std::uint16_t> samples,
                                                   HeightInterpolation interpolation) {
  require_size(columns, rows, samples.size());
  return HeightGrid::from_words(columns, rows, std::move(samples), interpolation);
}

}  // namespace oktett
