#pragma once
/// \file An image with its MIP levels, and filtered look-ups in it.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/soa.h"
#include "core/vec3.h"
#include "io/image/color.h"
#include "render/material.h"

namespace oktett {

/// The numbers of an image as they are stored, row by row from the top, channels of a pixel side by side:
/// grey or red, green, blue, then alpha if `alpha`. They are in one of the two columns; the other is empty.
struct TexelImage {
  std::uint32_t width = 0, height = 0;
  std::uint32_t colors = 1;  ///< channels of colour: 1 (grey) or 3
  bool alpha = false;
  ColorEncoding encoding;      ///< of the colours
  Column<std::uint8_t> bytes;  ///< 255 times the numbers, of 8-bit files
  Column<float> floats;        ///< of all others

  std::size_t channels() const { return colors + (alpha ? 1u : 0u); }
};

/// A place in an image and how it changes from a pixel of the picture to its neighbours. The unit is the
/// image's width or height: s goes from the left edge (0) to the right (1), t from the upper edge down.
struct TexturePatch {
  float s = 0, t = 0;
  float dsdx = 0, dtdx = 0;  ///< to the next column of the picture
  float dsdy = 0, dtdy = 0;  ///< to the next row
};

/// An image, halved until one pixel is left. Each level is the average, in linear light, of the pixels of the
/// level above that its pixels cover.
///
/// A look-up takes the ellipse onto which a pixel of the picture falls. Along its longer axis at most 16
/// points are averaged; each is bilinear in the two levels whose pixels are next in size to the shorter axis,
/// and mixed linearly in that size [McCormack 1999]. A patch smaller than a pixel of the image is bilinear
/// in it; with TextureFilter::nearest it is the one pixel that it is in. The results are the same bits on
/// every machine.
class MipMap {
 public:
  /// Memory per pixel: 4/3 of 4 bytes per channel (channels that are linear as stored), at most a byte and
  /// 8/3 per channel of an 8-bit image. Throws std::bad_alloc.
  explicit MipMap(TexelImage image);

  /// Linear Rec.709; grey is repeated.
  Color color(const TexturePatch& patch, TextureLookup lookup) const;
  /// The colours as stored; grey is repeated.
  Color stored(const TexturePatch& patch, TextureLookup lookup) const;
  /// A channel as stored; an alpha that is not there is 1.
  float channel(ImageChannel channel, const TexturePatch& patch, TextureLookup lookup) const;

  /// How many levels there are, and their sizes.
  std::size_t levels() const { return levels_.size(); }
  std::array<std::uint32_t, 2> size(std::size_t level) const {
    return {levels_[level].width, levels_[level].height};
  }

 private:
  struct Level {
    std::uint32_t width, height;
    std::size_t offset;  ///< of its first number in floats_; unused for a level of bytes
  };
  /// Which numbers a look-up reads.
  struct Channels {
    std::uint32_t in_bytes;   ///< the first one, in a level of bytes
    std::uint32_t in_floats;  ///< the same in other levels
    const float* of_byte;     ///< the number that each byte means
  };

  struct Neighbours;
  static Neighbours neighbours(float place, std::uint32_t size, TextureWrap wrap);

  bool in_bytes(std::size_t level) const { return level == 0 && !bytes_.empty(); }
  void halve(std::size_t level);
  void expand_row(std::size_t level, std::uint32_t y, float* row) const;

  template <std::size_t N>
  std::array<float, N> texel(std::size_t level, std::uint32_t x, std::uint32_t y, const Channels&) const;
  template <std::size_t N>
  std::array<float, N> bilinear(std::size_t level, float s, float t, TextureLookup lookup,
                                const Channels&) const;
  template <std::size_t N>
  std::array<float, N> nearest(float s, float t, TextureLookup lookup, const Channels&) const;
  template <std::size_t N>
  std::array<float, N> trilinear(float size, float s, float t, TextureLookup lookup, const Channels&) const;
  template <std::size_t N>
  std::array<float, N> filtered(const TexturePatch&, TextureLookup lookup, const Channels&) const;
  Color colors(const TexturePatch&, TextureLookup lookup, const Channels&) const;

  std::vector<Level> levels_;
  Column<std::uint8_t> bytes_;  ///< level 0 of an 8-bit image: the colours as stored, then alpha
  Column<float> floats_;        ///< all others: linear colours, the colours as stored, then alpha
  std::uint32_t colors_ = 1;
  bool alpha_ = false;
  std::uint32_t byte_channels_ = 0;   ///< per pixel
  std::uint32_t float_channels_ = 0;  ///< per pixel
  std::uint32_t stored_at_ = 0;       ///< 0 also if what is stored is linear
  std::array<float, 256> linear_of_byte_{};
  std::array<float, 256> stored_of_byte_{};
};

}  // namespace oktett
