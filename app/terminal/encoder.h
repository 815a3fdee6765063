#pragma once
/// \file Pictures as bytes that terminals show, behind an interface: what implements it is a shared library
/// that `oktett render --show` loads, so that other runs start without it.

#include <cstdint>
#include <string>
#include <vector>

namespace oktett {

/// How a terminal is told of a picture: by one of three protocols for pixels, or as coloured block
/// characters.
enum class TerminalFormat { kitty, iterm, sixel, blocks };

/// Eight-bit RGBA that is not multiplied by A, row by row from the top.
struct TerminalPixels {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

/// Pixels of a cell, along each side, from which its block character is chosen.
inline constexpr int kBlockPixels = 8;
/// The height of a picture of sixels is a multiple of it.
inline constexpr int kSixelPixels = 6;

/// The place of a picture on a terminal.
struct TerminalCells {
  int columns = 0, rows = 0;
  int cell_width = 0, cell_height = 0;  ///< of one cell, in pixels of the screen
};

/// The environment variables of the process say which terminal it is.
class TerminalEncoder {
 public:
  /// The best format that the terminal is known to have.
  virtual TerminalFormat best_format() const = 0;
  /// The bytes that show `pixels` from the cursor on. They cover `cells` exactly: each cell has as many
  /// pixels as on the screen, for blocks kBlockPixels along each side. Sixels know no cells; they cover their
  /// own pixels. Blocks have the colours that the terminal is known to have. The last line is not ended.
  virtual std::string encode(const TerminalPixels& pixels, TerminalFormat format,
                             const TerminalCells& cells) const = 0;

 protected:
  ~TerminalEncoder() = default;
};

/// The symbol that the shared library has.
inline constexpr const char* kTerminalEncoderSymbol = "oktett_terminal_encoder";
using GetTerminalEncoder = const TerminalEncoder* (*)();

/// Loads the library. Throws Error if this build has none.
const TerminalEncoder& terminal_encoder();

}  // namespace oktett
