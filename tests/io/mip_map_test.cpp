#include "io/image/mip_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>
#include <vector>

namespace oktett::mip_map_test {
namespace {

TexelImage noise(std::uint32_t width, std::uint32_t height, std::uint32_t colors, unsigned seed) {
  TexelImage image;
  image.width = width;
  image.height = height;
  image.colors = colors;
  image.floats.resize_uninitialized(std::size_t{width} * height * colors);
  std::mt19937 random(seed);
  for (float& v : image.floats) v = static_cast<float>(random() >> 8) * 0x1p-24f;
  return image;
}

TextureLookup lookup_of(bool clamp) { return clamp ? kClampedTexture : TextureLookup{}; }

/// The first channel of pixel (x, y) of `image` and what is around it.
double pixel(const TexelImage& image, long x, long y, TextureLookup lookup) {
  const auto in = [](long i, long n, TextureWrap w) {
    const long in_one = ((i % n) + n) % n, in_two = ((i % (2 * n)) + 2 * n) % (2 * n);
    if (w == TextureWrap::mirror) return std::min(in_two, 2 * n - 1 - in_two);
    return w == TextureWrap::clamp ? std::clamp(i, 0l, n - 1) : in_one;
  };
  const auto at =
      static_cast<std::size_t>(in(y, image.height, lookup.v) * image.width + in(x, image.width, lookup.u));
  return static_cast<double>(image.floats[at * image.channels()]);
}

/// Bilinear at (s, t), written down as the sum of all four corners.
double bilinear(const TexelImage& image, double s, double t, TextureLookup lookup) {
  const double x = s * image.width - 0.5, y = t * image.height - 0.5;
  double sum = 0;
  for (const long i : {0l, 1l})
    for (const long j : {0l, 1l}) {
      const long column = std::lround(std::floor(x)) + i, row = std::lround(std::floor(y)) + j;
      sum += (1 - std::abs(x - static_cast<double>(column))) * (1 - std::abs(y - static_cast<double>(row))) *
             pixel(image, column, row, lookup);
    }
  return sum;
}

/// Calls f(s, t, u, v, change) for places in and beyond the image, all ways to go on there, and changes to
/// the next pixel of the picture that are smaller than a pixel of the image.
template <class F>
void for_places(unsigned seed, const F& f) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> beyond(-2, 3);
  constexpr TextureWrap kAll[] = {TextureWrap::repeat, TextureWrap::clamp, TextureWrap::mirror};
  for (int i = 0; i < 500; ++i)
    for (const TextureWrap u : kAll)
      for (const TextureWrap v : kAll) {
        const float s = beyond(random), t = beyond(random);
        f(s, t, u, v, i % 2 == 0 ? 0.0f : 0.05f);
      }
}

TEST(MipMap, WithoutChangesBilinear) {
  const TexelImage image = noise(13, 7, 1, 1);
  const MipMap map(image);
  for_places(2, [&](float s, float t, TextureWrap u, TextureWrap v, float change) {
    ASSERT_NEAR(map.color({s, t, change, 0, 0, change}, {u, v}).x, bilinear(image, s, t, {u, v}), 6e-6)
        << s << " " << t;
  });
}

/// A place shows the pixel that it is in. Where pixels of the picture are larger, both filters are alike.
TEST(MipMap, NearestShowsOnePixel) {
  const TexelImage image = noise(13, 7, 1, 4);
  const MipMap map(image);
  for_places(5, [&](float s, float t, TextureWrap u, TextureWrap v, float change) {
    const TextureLookup nearest{u, v, TextureFilter::nearest};
    const double x = double{s} * image.width, y = double{t} * image.height;
    // At the edge of a pixel rounding decides.
    if (std::abs(x - std::round(x)) < 1e-4 || std::abs(y - std::round(y)) < 1e-4) return;
    const double is = pixel(image, std::lround(std::floor(x)), std::lround(std::floor(y)), nearest);
    ASSERT_EQ(static_cast<double>(map.color({s, t, change, 0, 0, change}, nearest).x), is) << s << " " << t;
    const TexturePatch large{s, t, 0.3f, 0, 0, 0.5f};
    ASSERT_EQ(map.color(large, nearest).x, map.color(large, {u, v}).x);
  });
}

/// A patch whose pixels are those of a level.
TexturePatch patch_of_level(const TexelImage& image, std::size_t level, float s, float t) {
  const float size = std::exp2(static_cast<float>(level));
  return {s, t, size / static_cast<float>(image.width), 0, 0, size / static_cast<float>(image.height)};
}

TEST(MipMap, LevelsAreAveragesOfBlocks) {
  const TexelImage image = noise(32, 8, 1, 3);
  const MipMap map(image);
  ASSERT_EQ(map.levels(), 6u);
  for (std::uint32_t level = 1; level < 6; ++level) {
    const std::uint32_t width = 32u >> level, height = std::max(8u >> level, 1u);
    ASSERT_EQ(map.size(level), (std::array<std::uint32_t, 2>{width, height}));
    for (std::uint32_t y = 0; y < height; ++y)
      for (std::uint32_t x = 0; x < width; ++x) {
        double sum = 0;
        for (std::uint32_t j = y * 8 / height; j < (y + 1) * 8 / height; ++j)
          for (std::uint32_t i = x * 32 / width; i < (x + 1) * 32 / width; ++i)
            sum += pixel(image, i, j, kClampedTexture);
        const double mean = sum * width * height / (32 * 8);
        const float s = (static_cast<float>(x) + 0.5f) / static_cast<float>(width);
        const float t = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
        ASSERT_NEAR(map.color(patch_of_level(image, level, s, t), lookup_of(true)).x, mean, 1e-6)
            << level << " " << x << " " << y;
      }
  }
}

// Sides that are no powers of two lose no row or column: the last level is the mean of all pixels, and a
// wedge whose pixels are all different moves it if one counts more than another.
TEST(MipMap, OddSidesKeepTheMean) {
  for (const auto& [width, height] : {std::array{3u, 1u}, {1u, 5u}, {7u, 11u}, {100u, 37u}, {255u, 3u}}) {
    TexelImage image = noise(width, height, 1, 4);
    double sum = 0;
    for (std::size_t i = 0; i < image.floats.size(); ++i) {
      image.floats[i] += static_cast<float>(i % 17) + static_cast<float>(i / width);
      sum += static_cast<double>(image.floats[i]);
    }
    const double mean = sum / static_cast<double>(image.floats.size());
    const MipMap map(std::move(image));
    EXPECT_NEAR(map.color({0.3f, 0.6f, 16, 0, 0, 16}, lookup_of(false)).x, mean, 2e-6 * mean)
        << width << " " << height;
  }
}

TEST(MipMap, AnEvenImageStaysEvenWhateverThePatch) {
  TexelImage image = noise(21, 10, 3, 5);
  for (std::size_t i = 0; i < image.floats.size(); ++i) image.floats[i] = i % 3 == 0 ? 0.1f : 7.3f;
  const MipMap map(std::move(image));
  std::mt19937 random(6);
  std::uniform_real_distribution<float> change(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const float size = std::exp2(static_cast<float>(i % 12) - 7);
    const TexturePatch patch{change(random),        change(random),        size * change(random),
                             size * change(random), size * change(random), size * change(random)};
    const Color c = map.color(patch, lookup_of(i % 2 == 0));
    ASSERT_NEAR(c.x, 0.1f, 1e-7);
    ASSERT_NEAR(c.y, 7.3f, 5e-6);
  }
}

/// The mean of the image over the patch, from 32 x 32 points of a pixel of the picture.
double mean_over(const TexelImage& image, const TexturePatch& p) {
  double sum = 0;
  for (int i = 0; i < 32; ++i)
    for (int j = 0; j < 32; ++j) {
      const double x = (i + 0.5) / 32 - 0.5, y = (j + 0.5) / 32 - 0.5;
      sum += bilinear(
          image, static_cast<double>(p.s) + x * static_cast<double>(p.dsdx) + y * static_cast<double>(p.dsdy),
          static_cast<double>(p.t) + x * static_cast<double>(p.dtdx) + y * static_cast<double>(p.dtdy),
          TextureLookup{});
    }
  return sum / 1024;
}

// Against the mean over the parallelogram, on noise and on an image whose width is not its height. Of the
// variance of such means no more than a part is error, and a patch turned by a quarter has several times
// that.
TEST(MipMap, LongPatchesAverageAlongTheirLongerAxis) {
  for (const auto& [width, height] : {std::array{64u, 64u}, {128u, 32u}}) {
    const TexelImage image = noise(width, height, 1, 7);
    const MipMap map(image);
    std::mt19937 random(8);
    std::uniform_real_distribution<float> unit(0, 1);
    double error = 0, turned = 0, variance = 0;
    const int count = 600;
    for (int i = 0; i < count; ++i) {
      // In pixels of the image: twelve long and two wide, in any direction, and slanted.
      const float angle = 6.2831853f * unit(random), slant = unit(random) - 0.5f;
      const float along_x = 12 * std::cos(angle), along_y = 12 * std::sin(angle);
      const float across_x = -along_y / 6 + slant * along_x, across_y = along_x / 6 + slant * along_y;
      const auto w = static_cast<float>(width), h = static_cast<float>(height);
      const TexturePatch patch{unit(random), unit(random), along_x / w,
                               along_y / h,  across_x / w, across_y / h};
      const TexturePatch quarter{patch.s, patch.t, -along_y / w, along_x / h, -across_y / w, across_x / h};
      const double truth = mean_over(image, patch);
      const auto squared = [](double v) { return v * v; };
      error += squared(static_cast<double>(map.color(patch, lookup_of(false)).x) - truth);
      turned += squared(static_cast<double>(map.color(quarter, lookup_of(false)).x) - truth);
      variance += squared(truth - 0.5);
    }
    EXPECT_LT(error, 0.45 * variance) << width;
    EXPECT_GT(turned, 3 * error) << width;
  }
}

// The width of what is averaged: on stripes of one pixel, the contrast that is left across and along them.
TEST(MipMap, StripesVanishAcrossAndStayAlong) {
  TexelImage image = noise(64, 64, 1, 9);
  for (std::size_t i = 0; i < image.floats.size(); ++i) image.floats[i] = i % 64 % 2 == 0 ? 1.0f : 0.0f;
  const MipMap map(std::move(image));
  const float white = 32.5f / 64;
  for (const float size : {4.0f, 9.0f, 15.0f}) {
    EXPECT_NEAR(map.color({white, 0.5f, size / 64, 0, 0, 1.0f / 64}, lookup_of(false)).x, 0.5f, 0.13f)
        << size;
    EXPECT_EQ(map.color({white, 0.5f, 1.0f / 64, 0, 0, size / 64}, lookup_of(false)).x, 1) << size;
  }
}

// Coloured, grey, 8-bit and float images of the same numbers give the same.
TEST(MipMap, KindsOfImagesAgree) {
  std::mt19937 random(10);
  TexelImage bytes;
  bytes.width = 19;
  bytes.height = 12;
  bytes.alpha = true;
  bytes.encoding = {TransferCurve::srgb, 1};
  bytes.bytes.resize_uninitialized(19 * 12 * 2);
  for (std::uint8_t& v : bytes.bytes) v = static_cast<std::uint8_t>(random());
  TexelImage floats = bytes;
  floats.bytes.clear();
  floats.colors = 3;
  for (std::size_t i = 0; i < 19 * 12; ++i) {
    for (int c = 0; c < 3; ++c) floats.floats.push_back(static_cast<float>(bytes.bytes[2 * i]) / 255.0f);
    floats.floats.push_back(static_cast<float>(bytes.bytes[2 * i + 1]) / 255.0f);
  }
  const MipMap a(bytes), b(floats);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int i = 0; i < 1000; ++i) {
    const float size = std::exp2(6 * unit(random) - 5);
    const TexturePatch patch{unit(random), unit(random), size, size * unit(random), 0, size * unit(random)};
    ASSERT_EQ(a.color(patch, lookup_of(false)), b.color(patch, lookup_of(false)));
    ASSERT_EQ(a.stored(patch, lookup_of(false)), b.stored(patch, lookup_of(false)));
    ASSERT_NE(a.stored(patch, lookup_of(false)), a.color(patch, lookup_of(false)));
    for (const ImageChannel channel :
         {ImageChannel::red, ImageChannel::green, ImageChannel::blue, ImageChannel::alpha})
      ASSERT_EQ(a.channel(channel, patch, lookup_of(false)), b.channel(channel, patch, lookup_of(false)));
    ASSERT_EQ(a.channel(ImageChannel::blue, patch, lookup_of(false)), a.stored(patch, lookup_of(false)).z);
  }
}

// Pictures are compared between processors and compilers, and these are part of them.
TEST(MipMap, BitsAreTheSameOnEveryMachine) {
  const MipMap map(noise(45, 28, 3, 11));
  std::mt19937 random(12);
  const auto unit = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
  std::uint64_t hash = 0;
  for (int i = 0; i < 5000; ++i) {
    TexturePatch patch{unit(), unit()};
    const float size = std::bit_cast<float>((117u + static_cast<std::uint32_t>(i) % 12) << 23);
    patch.dsdx = size * unit();
    patch.dtdx = size * unit();
    patch.dsdy = size * unit();
    patch.dtdy = size * unit();
    const Color c = map.color(patch, lookup_of(i % 2 == 0));
    for (const float v : {c.x, c.y, c.z}) hash = (hash ^ std::bit_cast<std::uint32_t>(v)) * 0x100000001b3u;
  }
  EXPECT_EQ(hash, 5509113479268296741u);
}

}  // namespace
}  // namespace oktett::mip_map_test
