#include "io/image/encode.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "io/image/color.h"
#include "render/tone.h"

namespace oktett::encode_test {
namespace {

/// A grey picture of one row.
Picture picture_of(const std::vector<float>& greys, double gamma) {
  Picture picture;
  picture.width = static_cast<std::uint32_t>(greys.size()), picture.height = 1;
  picture.tone.gamma = gamma;
  for (const char* const name : {"R", "G", "B"}) {
    PicturePlane& plane = picture.planes.emplace_back();
    plane.name = name;
    plane.values.resize_uninitialized(greys.size());
    for (std::size_t i = 0; i < greys.size(); ++i) plane.values[i] = greys[i];
  }
  return picture;
}

/// Every 37th float from 2^-16 to 2, and what is no light.
TEST(Encode, BytesAreThoseOfToneAndCurve) {
  std::vector<float> greys{0,
                           -0.0f,
                           -1,
                           1,
                           0x1p-13f,
                           std::numeric_limits<float>::infinity(),
                           -std::numeric_limits<float>::infinity(),
                           std::numeric_limits<float>::quiet_NaN()};
  for (auto bits = std::bit_cast<std::uint32_t>(0x1p-16f); bits < std::bit_cast<std::uint32_t>(2.0f);
       bits += 37)
    greys.push_back(std::bit_cast<float>(bits));
  for (const double gamma : {0.5, 1.0, 1.001, 1.8, 2.2, 2.25, 2.5}) {
    const Picture picture = picture_of(greys, gamma);
    const FlatImage flat = flatten(picture, PixelLayout::srgb8);
    ASSERT_EQ(flat.bytes.size(), 3 * greys.size());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < greys.size(); i += i < 8 ? 1 : 11) {
      const float x = greys[i];
      wrong += flat.bytes[3 * i] != linear_to_srgb8(toned(picture.tone, {x, x, x}).x);
    }
    EXPECT_EQ(wrong, 0u) << gamma;
  }
}

}  // namespace
}  // namespace oktett::encode_test
