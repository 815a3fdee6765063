#pragma once
/// \file A picture in the size in which a terminal shows it.

#include "app/terminal/encoder.h"
#include "io/image/encode.h"

namespace oktett {

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

}  // namespace oktett
