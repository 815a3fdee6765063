#include "app/terminal/preview.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "app/text.h"
#include "core/error.h"

namespace oktett {

// ---- A picture in the size in which a terminal shows it.

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

namespace {

constexpr const char* kAutomatic = "auto";
/// In the order of TerminalFormat.
const std::vector<std::string> kFormats{"kitty", "iterm", "sixel", "blocks"};

std::string_view variable(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

/// The whole number that an environment variable holds; `otherwise` if it holds none from 1 to 10000.
int number_of(const char* name, int otherwise) {
  int value = 0;
  return parse_number(variable(name), value) && value >= 1 && value <= 10000 ? value : otherwise;
}

/// Lines that stay free for the progress, the times, the name of the picture and the shell's next prompt.
constexpr int kOtherRows = 4;
/// Sizes beyond these are no terminal's.
constexpr int kMostColumns = 1000, kMostRows = 1000, kMostCellPixels = 128;
constexpr int kUnbounded = 1000;  ///< rows where nothing tells how many there are

TerminalRoom room_on(std::FILE* stream) {
  winsize size{};
  TerminalRoom room;
  if (ioctl(fileno(stream), TIOCGWINSZ, &size) != 0) size = {};
  room.columns = size.ws_col > 0 ? size.ws_col : number_of("COLUMNS", 80);
  room.rows = (size.ws_row > 0 ? size.ws_row : number_of("LINES", kUnbounded)) - kOtherRows;
  if (size.ws_col > 0 && size.ws_row > 0 && size.ws_xpixel >= size.ws_col && size.ws_ypixel >= size.ws_row) {
    room.cell_width = std::min(size.ws_xpixel / size.ws_col, kMostCellPixels);
    room.cell_height = std::min(size.ws_ypixel / size.ws_row, kMostCellPixels);
  }
  room.columns = std::clamp(room.columns, 1, kMostColumns);
  room.rows = std::clamp(room.rows, 1, kMostRows);
  return room;
}

void check_terminal(std::FILE* stream) {
  if (isatty(fileno(stream)) != 1)
    throw Error(fmt::format("--show: standard {} is no terminal; --show=FORMAT prints to it all the same",
                            stream == stderr ? "error" : "output"));
  const std::string_view kind = variable("TERM");
  if (kind.empty() || kind == "dumb")
    throw Error(fmt::format(
        "--show: a terminal with TERM={} has no colours; --show=FORMAT prints to it all the same", kind));
}

}  // namespace

void add_show_option(Verb& verb, std::string& format) {
  verb.flag("--show{auto}", format,
            "Print the picture on the terminal; --show=FORMAT in this way: kitty, iterm, sixel or blocks");
}

TerminalPreview::TerminalPreview(const std::string& format, std::FILE* to) : to_(to) {
  const auto found = std::ranges::find(kFormats, format);
  if (found == kFormats.end() && format != kAutomatic)
    throw Error(fmt::format("--show: unknown format '{}'{}", format,
                            did_you_mean(format, kFormats, "expected " + or_list(kFormats))));
  if (format == kAutomatic) check_terminal(to);
  encoder_ = &terminal_encoder();
  format_ =
      format == kAutomatic ? encoder_->best_format() : static_cast<TerminalFormat>(found - kFormats.begin());
}

void TerminalPreview::print(const Picture& picture) const {
  if (picture.width == 0 || picture.height == 0) return;
  const FittedPicture fitted = fit(flatten(picture, PixelLayout::srgb8_alpha), format_, room_on(to_));
  const std::string text = encoder_->encode(fitted.pixels, format_, fitted.cells) + "\n";
  std::fwrite(text.data(), 1, text.size(), to_);
  std::fflush(to_);
}

}  // namespace oktett
