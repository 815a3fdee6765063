#pragma once
/// \file Samples of a height field, and the pyramid of their least and greatest values over ever larger
/// blocks (F. K. Musgrave: Grid Tracing, 1988; A. Tevs, I. Ihrke, H.-P. Seidel: Maximum Mipmaps, 2008).

#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/pages.h"
#include "core/platform.h"
#include "core/simd_memory.h"
#include "core/soa.h"
#include "kernels/heights/height_field_data.h"

namespace oktett {

/// Most samples along a side, and in all.
inline constexpr std::uint32_t kMaxHeightSide = 32768;
inline constexpr std::size_t kMaxHeightSamples = std::size_t{1} << 28;

/// The least and greatest value over each of 4 x 4 blocks of cells, row by row, in steps of HeightGrid::step.
struct alignas(64) HeightNode {
  std::uint16_t least[16], greatest[16];
};
static_assert(sizeof(HeightNode) == 64);

/// The least and greatest values of the blocks of the last level, in the order in which lines of one quadrant
/// pass them; infinity and -infinity where there is no block.
struct alignas(64) HeightRoot {
  float least[16], greatest[16];
};

/// Immutable. Samples are 16-bit numbers or floats; they stand in tiles, so that what is near each other in
/// the field is so in memory. A tile has the 9 x 9 samples of 8 x 8 cells: those on its borders also stand in
/// the next tiles, so that the samples of a cell are always at the same distances. Cell (i, j) lies between
/// the columns i and i + 1 and the rows j and j + 1. Blocks of level k of the pyramid have 4^(k + 1) cells
/// along a side, and a node has 4 x 4 blocks; the last level has one node. Every line tests it, so it should
/// have more than 2 x 2 blocks; where it would not, the nodes of the level below have 2 x 2 blocks. The
/// pyramid takes about a tenth of the bytes of 16-bit samples.
class HeightGrid {
 public:
  /// Cells along a side of the smallest blocks, and blocks along a side of a node.
  static constexpr std::uint32_t kBlock = 4;
  static constexpr int kMaxLevels = 7;  ///< 4^8 > kMaxHeightSide

  struct Level {
    std::uint32_t side = 0;   ///< cells along a side of its blocks
    std::uint32_t split = 0;  ///< blocks along a side of its nodes: kBlock, or 2
    std::uint32_t block_columns = 0, block_rows = 0;
    std::uint32_t columns = 0, rows = 0;  ///< of nodes
    std::size_t first = 0;                ///< of its nodes

    /// Block k of node (i, j).
    OKTETT_INLINE std::uint32_t block_column(std::uint32_t i, unsigned k) const {
      return split * i + k % kBlock;
    }
    OKTETT_INLINE std::uint32_t block_row(std::uint32_t j, unsigned k) const {
      return split * j + k / kBlock;
    }
    OKTETT_INLINE bool has_block(std::uint32_t column, std::uint32_t row) const {
      return column < block_columns && row < block_rows;
    }
  };

  /// Sample (i, j) has the value words[i + j * columns] / 65535.
  static std::shared_ptr<const HeightGrid> from_words(std::uint32_t columns, std::uint32_t rows,
                                                      Column<std::uint16_t> words,
                                                      HeightInterpolation interpolation);
  /// Sample (i, j) has the value floats[i + j * columns], which is finite.
  static std::shared_ptr<const HeightGrid> from_floats(std::uint32_t columns, std::uint32_t rows,
                                                       Column<float> floats,
                                                       HeightInterpolation interpolation);

  OKTETT_INLINE std::uint32_t columns() const { return columns_; }
  OKTETT_INLINE std::uint32_t rows() const { return rows_; }
  OKTETT_INLINE HeightInterpolation interpolation() const { return interpolation_; }
  /// What a sample as it is stored is multiplied by to be a value.
  double unit() const { return word_data_ == nullptr ? 1.0 : 1.0 / 65535; }
  /// The least and greatest sample as stored.
  OKTETT_INLINE double least() const { return least_; }
  OKTETT_INLINE double greatest() const { return greatest_; }
  /// Of samples and pyramid.
  std::size_t bytes() const {
    return places() * (word_data_ != nullptr ? sizeof(std::uint16_t) : sizeof(float)) +
           node_count_ * sizeof(HeightNode);
  }

  // What walks need, without bounds checks.

  /// Sample (i, j) as stored.
  OKTETT_INLINE double at(std::uint32_t i, std::uint32_t j) const {
    // The last column and row have no cells of their own.
    const std::uint32_t x = i < cells(columns_) ? i : i - 1, z = j < cells(rows_) ? j : j - 1;
    return load(cell_place(x, z) + (i - x) + kRow * (j - z));
  }
  /// Where the samples of cell (i, j) stand: (i, j) there, (i + 1, j) next to it. In lanes, all are whole
  /// numbers.
  OKTETT_INLINE std::size_t cell_place(std::uint32_t i, std::uint32_t j) const {
    return std::size_t{i / kTile} * kTileSamples + i % kTile + j / kTile * tile_row_ + j % kTile * kRow;
  }
  template <class D>
  OKTETT_INLINE D cell_place(const D& i, const D& j) const {
    return (i + D(double{kTileSamples - kTile}) * tile_of(i)) +
           (D(double{kRow}) * j + D(static_cast<double>(tile_row_) - kRow * kTile) * tile_of(j));
  }
  /// Where the next row of a cell stands.
  template <class Place>
  static OKTETT_INLINE Place place_below(const Place& place) {
    return place + Place(kRow);
  }
  /// The samples at `place` and next to it.
  OKTETT_INLINE void load_pair(std::size_t place, double& first, double& second) const {
    first = load(place), second = load(place + 1);
  }
  template <class D>
  OKTETT_INLINE void load_pair(const D& place, D& first, D& second) const {
    if (word_data_ != nullptr)
      gather_pairs(word_data_, place, first, second);
    else
      gather_pairs(float_data_, place, first, second);
  }
  /// Prefetches the samples of the block whose first cell is (i, j).
  OKTETT_INLINE void prefetch_block(std::uint32_t i, std::uint32_t j) const {
    const std::size_t size = word_data_ != nullptr ? sizeof(std::uint16_t) : sizeof(float);
    const auto* samples = word_data_ != nullptr ? reinterpret_cast<const char*>(word_data_)
                                                : reinterpret_cast<const char*>(float_data_);
    // Its first, middle and last sample: they are less than a cache line apart if samples have 16 bits.
    const std::size_t place = cell_place(i, j);
    for (const std::size_t k :
         {std::size_t{0}, std::size_t{kBlock / 2 * (kRow + 1)}, std::size_t{kBlock * (kRow + 1)}})
      __builtin_prefetch(samples + (place + k) * size);
  }
  OKTETT_INLINE int levels() const { return levels_; }
  OKTETT_INLINE const Level& level(int k) const { return level_[k]; }
  OKTETT_INLINE const HeightNode& node(int level, std::uint32_t i, std::uint32_t j) const {
    const Level& l = level_[level];
    return node_data_[l.first + i + std::size_t{j} * l.columns];
  }
  /// The last level for lines that go back in x (bit 0) and in z (bit 1).
  OKTETT_INLINE const HeightRoot& root(unsigned quadrant) const { return roots_[quadrant]; }
  /// A block has samples from least() + step() * node.least[...] to least() + step() * node.greatest[...].
  OKTETT_INLINE double step() const { return step_; }

 private:
  /// Cells along a side of a tile; its samples, in a row and in all.
  static constexpr std::uint32_t kTile = 8, kRow = kTile + 1, kTileSamples = kRow * kRow;

  HeightGrid(std::uint32_t columns, std::uint32_t rows, HeightInterpolation interpolation);
  /// Of a whole number: by rounding to a whole number what is at most 7/16 from it.
  template <class D>
  static OKTETT_INLINE D tile_of(const D& i) {
    const D shifter(0x1.8p52);
    return ((i * D(1.0 / kTile) - D(0.4375)) + shifter) - shifter;
  }
  template <class T>
  VirtualArray<T> take(const Column<T>& samples);
  OKTETT_INLINE double load(std::size_t place) const {
    return word_data_ != nullptr ? static_cast<double>(word_data_[place])
                                 : static_cast<double>(float_data_[place]);
  }
  /// Cells that `samples` along a side have a place for, and the tiles that these take. A single sample,
  /// which has no cell, has a place too.
  static OKTETT_INLINE std::uint32_t cells(std::uint32_t samples) { return samples > 2 ? samples - 1 : 1; }
  static std::uint32_t tiles(std::uint32_t samples) { return (cells(samples) + kTile - 1) / kTile; }
  std::size_t places() const { return tiles(rows_) * tile_row_; }
  void build_pyramid();
  void bound_cells(std::uint32_t i, std::uint32_t j, std::uint16_t& least, std::uint16_t& greatest) const;

  std::uint32_t columns_ = 0, rows_ = 0;
  HeightInterpolation interpolation_ = HeightInterpolation::bilinear;
  std::size_t tile_row_ = 0;  ///< samples in a row of tiles
  VirtualArray<std::uint16_t> words_;
  VirtualArray<float> floats_;
  VirtualArray<HeightNode> nodes_;
  std::size_t node_count_ = 0;
  const std::uint16_t* word_data_ = nullptr;
  const float* float_data_ = nullptr;
  const HeightNode* node_data_ = nullptr;
  double least_ = 0, greatest_ = 0, step_ = 1;
  Level level_[kMaxLevels];
  int levels_ = 0;
  HeightRoot roots_[4];
};

}  // namespace oktett
