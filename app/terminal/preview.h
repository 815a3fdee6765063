#pragma once
/// \file The finished picture of a render, on the terminal.

#include <cstdio>
#include <string>

#include "app/command_line.h"
#include "app/terminal/encoder.h"
#include "io/image/encode.h"
#include "render/picture.h"

namespace oktett {

// ---- A picture in the size in which a terminal shows it.

/// The room that a picture may take on a terminal.
struct TerminalRoom {
  int columns = 80, rows = 20;
  int cell_width = 8, cell_height = 16;  ///< of one cell, in pixels of the screen
};

/// Pixels for TerminalEncoder::encode, and the cells that they cover.
struct FittedPicture {
  TerminalPixels pixels;
  TerminalCells cells;
};

/// `image`, of 8-bit pixels, as large as it fits into `room`, but not larger than it is: one pixel of the
/// screen for each of its own, and of blocks one column for each. Pixels of smaller pictures are averages of
/// the 8-bit colours. What is left of the cells, or of a row of sixels, at the right and below is
/// transparent.
FittedPicture fit(const FlatImage& image, TerminalFormat format, const TerminalRoom& room);

/// The option --show: `format` is empty if it is not given.
void add_show_option(Verb& verb, std::string& format);

/// Prints pictures on a terminal. Made before the render, so that what is missing is known by then.
class TerminalPreview {
 public:
  /// `format`: what --show asks for; "auto" is the best format that the terminal has, and needs one. `to` is
  /// standard output or standard error. Throws Error for an unknown format, for a stream that is no terminal
  /// and for a terminal without colours, and if what encodes pictures is not there.
  TerminalPreview(const std::string& format, std::FILE* to);

  /// Prints `picture`, as its PNG would show it, as large as the terminal now has room for, and ends the
  /// line.
  void print(const Picture& picture) const;

 private:
  std::FILE* to_;
  const TerminalEncoder* encoder_ = nullptr;
  TerminalFormat format_ = TerminalFormat::blocks;
};

}  // namespace oktett
