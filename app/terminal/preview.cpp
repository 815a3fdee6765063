#include "app/terminal/preview.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "app/text.h"
#include "core/error.h"
#include "core/suggest.h"

namespace oktett {
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
