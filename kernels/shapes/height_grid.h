#pragma once
/// \file Samples of a height field, and the pyramid of their least and greatest values over ever larger
/// blocks (F. K. Musgrave: Grid Tracing, 1988; A. Tevs, I. Ihrke, H.-P. Seidel: Maximum Mipmaps, 2008).

#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/platform.h"
#include "core/soa.h"
#include "core/virtual_array.h"
#include "kernels/shapes/height_data.h"

namespace oktett {

/// Most samples along a side, and in all.
inline constexpr std::uint32_t kMaxHeightSide = 32768;
inline constexpr std::size_t kMaxHeightSamples = std::size_t{1} << 28;

/// The least and greatest value over a block of cells, in steps of HeightGrid::step.
struct HeightRange {
  std::uint16_t least, greatest;
};
static_assert(sizeof(HeightRange) == 4);

/// Immutable. Samples are 16-bit numbers or floats; they stand in tiles of 8 x 8, so that what is near each
/// other in the field is so in memory. Cell (i, j) lies between the columns i and i + 1 and the rows j and
/// j + 1. Level k of the pyramid has blocks of (4 << k) x (4 << k) cells; the last level has one block. That
/// adds 1/6 to 16-bit samples.
class HeightGrid {
 public:
  static constexpr int kBlock = 4;       ///< cells along a side of the smallest blocks
  static constexpr int kMaxLevels = 16;  ///< 4 << 15 > kMaxHeightSide

  struct Level {
    std::uint32_t columns = 0, rows = 0;
    std::uint32_t pairs = 0;  ///< of columns: the four blocks under one of the next level stand together
    std::size_t first = 0;    ///< of its blocks in `ranges`

    OKTETT_INLINE std::size_t at(std::uint32_t i, std::uint32_t j) const {
      return first + 4 * ((i >> 1) + std::size_t{j >> 1} * pairs) + (i & 1) + 2 * (j & 1);
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
           range_count_ * sizeof(HeightRange);
  }

  // What walks need, without bounds checks.

  /// Sample (i, j) as stored.
  OKTETT_INLINE double at(std::uint32_t i, std::uint32_t j) const {
    return load(column_place(i) + row_place(j));
  }
  /// Sample (i, j) stands at column_place(i) + row_place(j).
  OKTETT_INLINE std::size_t column_place(std::uint32_t i) const {
    return (std::size_t{i / kTile} * kTile * kTile) + i % kTile;
  }
  OKTETT_INLINE std::size_t row_place(std::uint32_t j) const {
    return j / kTile * tile_row_ + j % kTile * kTile;
  }
  OKTETT_INLINE double load(std::size_t place) const {
    return word_data_ != nullptr ? static_cast<double>(word_data_[place])
                                 : static_cast<double>(float_data_[place]);
  }
  OKTETT_INLINE int levels() const { return levels_; }
  OKTETT_INLINE const Level& level(int k) const { return level_[k]; }
  OKTETT_INLINE const HeightRange* ranges() const { return range_data_; }
  /// A block has samples from least() + step() * range.least to least() + step() * range.greatest.
  OKTETT_INLINE double step() const { return step_; }

 private:
  static constexpr std::uint32_t kTile = 8;

  HeightGrid(std::uint32_t columns, std::uint32_t rows, HeightInterpolation interpolation);
  template <class T>
  VirtualArray<T> take(const Column<T>& samples);
  std::size_t places() const { return (rows_ + kTile - 1) / kTile * tile_row_; }
  void build_pyramid();
  HeightRange range_of_block(std::uint32_t i, std::uint32_t j) const;

  std::uint32_t columns_ = 0, rows_ = 0;
  HeightInterpolation interpolation_ = HeightInterpolation::bilinear;
  std::size_t tile_row_ = 0;  ///< samples in a row of tiles
  VirtualArray<std::uint16_t> words_;
  VirtualArray<float> floats_;
  VirtualArray<HeightRange> ranges_;
  std::size_t range_count_ = 0;
  const std::uint16_t* word_data_ = nullptr;
  const float* float_data_ = nullptr;
  const HeightRange* range_data_ = nullptr;
  double least_ = 0, greatest_ = 0, step_ = 1;
  Level level_[kMaxLevels];
  int levels_ = 0;
};

}  // namespace oktett
