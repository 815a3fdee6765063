#pragma once
/// \file Images as textures want them. Knows OpenImageIO; not for other folders.

#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <vector>

#include "io/image/color.h"

namespace oktett::oiio {

/// Presents an image file to a texture cache as six channels: linear R, G, B, then the first three as
/// stored (a grey one repeated). Halves for 8-bit files, which lose nothing that 8 bits hold, floats for all
/// others. The path is handed over as the string attribute `oktett:path` of the configuration, so no
/// character of it has a meaning to the cache.
class TextureInput : public OIIO::ImageInput {
 public:
  static constexpr int kChannels = 6;
  static constexpr int kStoredChannel = 3;  ///< the first of those as stored

  /// In the form the cache's add_file wants.
  static OIIO::ImageInput* create() { return new TextureInput; }

  const char* format_name() const override { return "oktett-texture"; }
  bool open(const std::string& name, OIIO::ImageSpec& spec) override;
  bool open(const std::string& name, OIIO::ImageSpec& spec, const OIIO::ImageSpec& config) override;
  bool close() override;
  bool read_native_scanline(int subimage, int miplevel, int y, int z, void* data) override;

 private:
  bool read_pixels();
  void decode_row(int y, float* row) const;

  OIIO::ImageInput::unique_ptr input_;
  ColorEncoding encoding_;
  std::vector<float> curve_;   ///< decoded value of each 8-bit number; empty for other types
  std::vector<float> pixels_;  ///< the file's channels, from the first row read to the last
  int file_channels_ = 0;
};

}  // namespace oktett::oiio
