#include "io/image/oiio/texture_input.h"

#include <cstdint>
#include <exception>
#include <string>

#include "core/error.h"
#include "io/image/oiio/open_image.h"

namespace oktett::oiio {

using OIIO::TypeDesc;

bool TextureInput::open(const std::string&, OIIO::ImageSpec&) {
  errorfmt("a texture is opened by its configuration only");
  return false;
}

bool TextureInput::open(const std::string&, OIIO::ImageSpec& spec, const OIIO::ImageSpec& config) {
  try {
    input_ = open_image(std::string(config.get_string_attribute("oktett:path")));
  } catch (const Error& error) {
    errorfmt("{}", error.what());
    return false;
  }
  const OIIO::ImageSpec& file = input_->spec();
  encoding_ = color_encoding(file);
  file_channels_ = file.nchannels < 3 ? 1 : 3;
  curve_.clear();
  const bool eight_bit = file.format.basetype == TypeDesc::UINT8;
  if (eight_bit)
    for (int v = 0; v < 256; ++v) curve_.push_back(decode(encoding_, static_cast<float>(v) / 255.0f));
  m_spec = OIIO::ImageSpec(file.width, file.height, kChannels, eight_bit ? TypeDesc::HALF : TypeDesc::FLOAT);
  spec = m_spec;
  return true;
}

bool TextureInput::close() {
  input_.reset();
  pixels_ = {};
  return true;
}

/// Decodes the whole file: it may be compressed in a way that has no rows.
bool TextureInput::read_pixels() {
  const std::size_t count = static_cast<std::size_t>(m_spec.width) * static_cast<std::size_t>(m_spec.height) *
                            static_cast<std::size_t>(file_channels_);
  std::string why;
  try {
    pixels_.resize(count);
    if (input_->read_image(0, 0, 0, file_channels_, TypeDesc::FLOAT, pixels_.data())) return true;
    why = input_->geterror();
  } catch (const std::exception& error) {
    why = error.what();
  }
  pixels_ = {};
  errorfmt("cannot read the image: {}", first_line(why, "damaged file"));
  return false;
}

void TextureInput::decode_row(int y, float* row) const {
  const std::size_t width = static_cast<std::size_t>(m_spec.width);
  const std::size_t stored = static_cast<std::size_t>(file_channels_);
  const float* in = pixels_.data() + static_cast<std::size_t>(y) * width * stored;
  for (std::size_t x = 0; x < width; ++x, in += stored, row += kChannels) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float v = in[stored == 3 ? c : 0];
      row[c] = curve_.empty() ? decode(encoding_, v) : curve_[static_cast<std::uint8_t>(v * 255.0f + 0.5f)];
      row[kStoredChannel + c] = v;
    }
  }
}

bool TextureInput::read_native_scanline(int subimage, int miplevel, int y, int z, void* data) {
  if (!input_ || subimage != 0 || miplevel != 0 || z != 0 || y < 0 || y >= m_spec.height) return false;
  if (pixels_.empty() && !read_pixels()) return false;
  std::vector<float> row(static_cast<std::size_t>(m_spec.width) * kChannels);
  decode_row(y, row.data());
  const int numbers = static_cast<int>(row.size());
  OIIO::convert_pixel_values(TypeDesc::FLOAT, row.data(), m_spec.format, data, numbers);
  // The cache reads the image once, from the top down, and keeps what it needs.
  if (y == m_spec.height - 1) pixels_ = {};
  return true;
}

}  // namespace oktett::oiio
