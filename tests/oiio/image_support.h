#pragma once
/// \file Small pictures, and the kinds of errors, for the tests of image files.

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/error.h"
#include "render/picture.h"

namespace oktett::test {

/// A plane of numbers that grow by `step`.
inline PicturePlane float_plane(const char* name, PlaneType type, std::size_t pixels, float first,
                                float step) {
  PicturePlane plane{name, type, Column<float>(pixels), {}};
  for (std::size_t i = 0; i < pixels; ++i) plane.values[i] = first + step * static_cast<float>(i);
  return plane;
}

/// A picture of the given size with R, G, B, A that fills its frame.
inline Picture color_picture(std::uint32_t width, std::uint32_t height, float r, float g, float b, float a) {
  Picture picture;
  picture.width = picture.full_width = width;
  picture.height = picture.full_height = height;
  const std::size_t pixels = std::size_t{width} * height;
  const float values[4] = {r, g, b, a};
  const char* names[4] = {"R", "G", "B", "A"};
  for (int c = 0; c < 4; ++c)
    picture.planes.push_back({names[c], PlaneType::half_float, Column<float>(pixels, values[c]), {}});
  return picture;
}

/// Writes 8-bit or float pixels, row by row from the top, and returns the path.
template <class T>
std::string write_pixels(const std::string& path, int width, int height, int channels,
                         const std::vector<T>& pixels) {
  const OIIO::TypeDesc type = sizeof(T) == 1 ? OIIO::TypeUInt8 : OIIO::TypeFloat;
  OIIO::ImageSpec spec(width, height, channels, type);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  auto output = OIIO::ImageOutput::create(path);
  EXPECT_TRUE(output && output->open(path, spec) && output->write_image(type, pixels.data()) &&
              output->close());
  return path;
}

/// The kind of the Error, of one line, that `work` must throw.
inline ErrorKind kind_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.kind();
  }
  ADD_FAILURE() << "no Error was thrown";
  return ErrorKind::bad_input;
}

}  // namespace oktett::test
