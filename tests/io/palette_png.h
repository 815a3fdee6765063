#pragma once
/// \file PNG images with a palette, written byte by byte after the specification (ISO/IEC 15948), without
/// libpng.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace oktett::test {

inline std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}

/// A chunk with its check sum.
inline std::string png_chunk(std::string_view type, std::string_view data) {
  std::string checked = std::string(type) + std::string(data);
  std::uint32_t crc = 0xffffffff;
  for (const char c : checked) {
    crc ^= static_cast<unsigned char>(c);
    for (int k = 0; k < 8; ++k) crc = crc & 1 ? crc >> 1 ^ 0xedb88320 : crc >> 1;
  }
  return big_endian(static_cast<std::uint32_t>(data.size())) + checked + big_endian(~crc);
}

/// A stream of zlib that holds at most 65535 bytes as they are.
inline std::string stored_by_zlib(std::string_view data) {
  std::uint32_t a = 1, b = 0;
  for (const char c : data) a = (a + static_cast<unsigned char>(c)) % 65521, b = (b + a) % 65521;
  const auto size = static_cast<std::uint32_t>(data.size());
  std::string bytes = "\x78\x01\x01";
  for (const std::uint32_t n : {size, ~size})
    bytes += static_cast<char>(n), bytes += static_cast<char>(n >> 8);
  return bytes + std::string(data) + big_endian(b << 16 | a);
}

struct PalettePng {
  std::uint32_t width = 2, height = 2;
  int depth = 8;                                 ///< bits per pixel
  std::size_t colors = 256;                      ///< that the palette has
  std::vector<unsigned> numbers = {0, 1, 2, 3};  ///< of the colours of the pixels
  bool interlaced = false;                       ///< by Adam7
  char color_type = 3;                           ///< that the header names

  std::string pixels() const {
    static constexpr unsigned kPasses[7][4] = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
                                               {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};
    static constexpr unsigned kWhole[4] = {0, 0, 1, 1};
    std::string rows;
    for (int pass = 0; pass < (interlaced ? 7 : 1); ++pass) {
      const unsigned(&p)[4] = interlaced ? kPasses[pass] : kWhole;
      for (unsigned y = p[1]; y < height && p[0] < width; y += p[3]) {
        rows += '\0';
        unsigned bits = 0;
        int filled = 0;
        for (unsigned x = p[0]; x < width; x += p[2]) {
          bits = bits << depth | numbers[y * width + x], filled += depth;
          if (filled == 8) rows += static_cast<char>(bits), bits = 0, filled = 0;
        }
        if (filled > 0) rows += static_cast<char>(bits << (8 - filled));
      }
    }
    return rows;
  }
  std::string header() const {
    return "\x89PNG\r\n\x1a\n" +
           png_chunk("IHDR", big_endian(width) + big_endian(height) + static_cast<char>(depth) + color_type +
                                 std::string(2, '\0') + (interlaced ? '\1' : '\0'));
  }
  /// Colours that tell nothing of their numbers.
  std::string palette() const {
    std::string all;
    for (std::size_t i = 0; i < colors; ++i)
      all += static_cast<char>(255 - i), all += static_cast<char>(7 * i), all += '\x55';
    return png_chunk("PLTE", all);
  }
  std::string file() const {
    return header() + (color_type == 3 ? palette() : "") + png_chunk("IDAT", stored_by_zlib(pixels())) +
           png_chunk("IEND", "");
  }
};

}  // namespace oktett::test
