#pragma once
/// \file Reads pictures out of what is sent to a terminal, by the descriptions of the protocols.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace oktett::test {

/// Eight-bit RGBA, row by row from the top.
struct ShownPicture {
  int width = 0, height = 0;
  int columns = 0, rows = 0;  ///< cells that it covers; 0: the terminal finds out
  std::vector<std::uint8_t> rgba;

  const std::uint8_t* pixel(int x, int y) const {
    return &rgba[4 * (static_cast<std::size_t>(y) * width + x)];
  }
};

/// All bytes of a base64 text; none if it is no such text.
std::string decode_base64(const std::string& text);

/// The first picture of kitty's graphics protocol in `text`, sent as RGBA.
std::optional<ShownPicture> find_kitty(const std::string& text);
/// The bytes of the file in the first inline image of iTerm2 in `text`; none if there is no image.
std::string find_iterm(const std::string& text);
/// The first picture of sixels in `text`, with its own palette.
std::optional<ShownPicture> find_sixel(const std::string& text);

/// What the lines of spaces, half blocks and quarter blocks in `text` show, two pixels a cell along each
/// side. Understands colours of 24 bits and those of the 6x6x6 cube and the greys of 256; pixels in the
/// terminal's own colours are transparent. Lines without a colour are left out. Nothing if `text` has other
/// characters or sequences in lines with colours.
std::optional<ShownPicture> find_blocks(const std::string& text);

}  // namespace oktett::test
