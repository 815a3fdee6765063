#pragma once
/// \file Heights for height fields from image files.

#include <cstdint>
#include <string>

#include "core/soa.h"

namespace oktett {

/// One number per pixel, row by row from the top, in one of the two columns; the other is empty.
struct HeightImage {
  std::uint32_t columns = 0, rows = 0;
  Column<std::uint16_t> words;  ///< of 8-bit and 16-bit files: 65535 times the value
  Column<float> floats;         ///< of all others: the values as stored
};

/// Reads a grey image, or one whose red, green and blue are the same; alpha is ignored. The numbers are taken
/// as stored, without a transfer curve. Throws Error of kind io, without a line, if the file cannot be read,
/// is damaged, has colours or numbers that are not finite, or fewer than 2 or more than `most_side` pixels
/// along a side or `most_pixels` in all.
HeightImage read_heights(const std::string& path, std::uint32_t most_side, std::size_t most_pixels);

/// Whether the file is a PNG image whose pixels are numbers of colours in a palette. False for all that
/// cannot be read.
bool has_palette(const std::string& path);

/// Reads a PNG image with a palette: the heights, in `floats`, are the numbers of the colours from 0, divided
/// by 256, whatever the colours are. Needs no library of images. Throws Error of kind io, without a line, for
/// other images, for damaged files and colours that the palette lacks, and for sizes as read_heights does.
HeightImage read_palette_heights(const std::string& path, std::uint32_t most_side, std::size_t most_pixels);

}  // namespace oktett
