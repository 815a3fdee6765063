#include "app/terminal/fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace oktett {
namespace {

/// Along one axis: what cells and pixels a picture gets.
struct Extent {
  int cells = 1;
  std::uint32_t pixels = 1;  ///< of the picture in the new size
};

/// A share of a pixel of the old size in one of the new size.
struct Share {
  std::uint32_t pixel = 0;
  double weight = 0;
};

/// Which pixels of `from` make up pixel `at` of `to`. The weights add up to 1.
void find_shares(std::uint32_t from, std::uint32_t to, std::uint32_t at, std::vector<Share>& shares) {
  const double scale = static_cast<double>(from) / to, first = at * scale, last = (at + 1.0) * scale;
  shares.clear();
  for (auto i = static_cast<std::uint32_t>(first); i < from && i < last; ++i) {
    const double part = std::min(last, i + 1.0) - std::max(first, static_cast<double>(i));
    if (part > 1e-9 * scale) shares.push_back({i, part / scale});
  }
}

/// Adds row `y` of `image` times `weight` to `sums`, in the new width: R, G and B times A, and A.
void add_row(const FlatImage& image, std::uint32_t y, double weight,
             const std::vector<std::vector<Share>>& columns, std::vector<double>& sums) {
  const std::uint8_t* const row = image.bytes.data() + std::size_t{y} * image.width * image.channels;
  for (std::size_t x = 0; x < columns.size(); ++x)
    for (const Share& share : columns[x]) {
      const std::uint8_t* const pixel = row + std::size_t{share.pixel} * image.channels;
      const double a = weight * share.weight * (image.channels == 4 ? pixel[3] : 255);
      for (int k = 0; k < 3; ++k) sums[4 * x + k] += a * pixel[k];
      sums[4 * x + 3] += a;
    }
}

/// Writes `image` in the size `width` x `height` to the upper left of `to`.
void resize(const FlatImage& image, std::uint32_t width, std::uint32_t height, TerminalPixels& to) {
  std::vector<std::vector<Share>> columns(width);
  for (std::uint32_t x = 0; x < width; ++x) find_shares(image.width, width, x, columns[x]);
  std::vector<Share> rows;
  std::vector<double> sums(std::size_t{4} * width);
  for (std::uint32_t y = 0; y < height; ++y) {
    std::ranges::fill(sums, 0.0);
    find_shares(image.height, height, y, rows);
    for (const Share& row : rows) add_row(image, row.pixel, row.weight, columns, sums);
    std::uint8_t* out = to.rgba.data() + std::size_t{4} * y * to.width;
    for (std::size_t x = 0; x < width; ++x) {
      const double a = sums[4 * x + 3];
      for (int k = 0; k < 3; ++k)
        *out++ = static_cast<std::uint8_t>(a > 0 ? std::lround(sums[4 * x + k] / a) : 0);
      *out++ = static_cast<std::uint8_t>(std::lround(a));
    }
  }
}

std::uint32_t round_up(std::uint32_t number, int unit) {
  const auto step = static_cast<std::uint32_t>(unit);
  return (number + step - 1) / step * step;
}

/// Along one axis: what a cell is.
struct Axis {
  double size;  ///< in pixels of the picture that is as large as it may be
  int pixels;   ///< in pixels of the encoder
  int step;     ///< in such pixels: what one of its characters can tell apart
};

/// What `size` pixels of a picture get that is scaled by `scale`.
Extent extent_of(double size, double scale, const Axis& axis) {
  const auto steps = std::max(1l, std::lround(size * scale / axis.size * axis.pixels / axis.step));
  const auto pixels = static_cast<std::uint32_t>(steps * axis.step);
  return {static_cast<int>(round_up(pixels, axis.pixels) / axis.pixels), pixels};
}

}  // namespace

FittedPicture fit(const FlatImage& image, TerminalFormat format, const TerminalRoom& room) {
  Axis x{static_cast<double>(room.cell_width), room.cell_width, 1},
      y{static_cast<double>(room.cell_height), room.cell_height, 1};
  if (format == TerminalFormat::blocks) {
    x = {1, kBlockPixels, kBlockPixels / 2};
    y = {static_cast<double>(room.cell_height) / room.cell_width, kBlockPixels, kBlockPixels / 2};
  }
  const double scale =
      std::min({1.0, room.columns * x.size / image.width, room.rows * y.size / image.height});
  const Extent across = extent_of(image.width, scale, x), down = extent_of(image.height, scale, y);
  FittedPicture fitted;
  fitted.cells = {across.cells, down.cells, room.cell_width, room.cell_height};
  TerminalPixels& pixels = fitted.pixels;
  const bool sixels = format == TerminalFormat::sixel;
  pixels.width = sixels ? across.pixels : static_cast<std::uint32_t>(across.cells * x.pixels);
  pixels.height =
      sixels ? round_up(down.pixels, kSixelPixels) : static_cast<std::uint32_t>(down.cells * y.pixels);
  pixels.rgba.resize(std::size_t{4} * pixels.width * pixels.height);
  resize(image, across.pixels, down.pixels, pixels);
  return fitted;
}

}  // namespace oktett
