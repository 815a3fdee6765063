#include "io/image/contents.h"

#include <cmath>
#include <cstddef>

#include "core/error.h"
#include "io/image/library.h"

namespace oktett {
namespace {

/// Number `k` of an image, as stored.
float stored_number(const TexelImage& image, std::size_t k) {
  return image.bytes.empty() ? image.floats[k] : static_cast<float>(image.bytes[k]) / 255;
}

bool shows_normals(const TexelImage& image) {
  if (image.colors != 3) return false;
  const std::size_t pixels = std::size_t{image.width} * image.height, channels = image.channels();
  Vec3d sum{};
  std::size_t unit = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    const auto direction = [&](std::size_t c) {
      return 2 * static_cast<double>(stored_number(image, i * channels + c)) - 1;
    };
    const Vec3d n{direction(0), direction(1), direction(2)};
    // Compressed images are a little off.
    constexpr double kTolerance = 0.2;
    if (std::abs(length(n) - 1) < kTolerance && n.z > -kTolerance) ++unit;
    sum = sum + n;
  }
  const auto count = static_cast<double>(pixels);
  const Vec3d mean = sum / count;
  constexpr double kLean = 0.25, kUp = 0.5, kMost = 0.95;
  return std::abs(mean.x) < kLean && std::abs(mean.y) < kLean && mean.z > kUp &&
         static_cast<double>(unit) >= kMost * count;
}

bool shows_alpha(const TexelImage& image) {
  if (!image.alpha) return false;
  const std::size_t pixels = std::size_t{image.width} * image.height, channels = image.channels();
  for (std::size_t i = 0; i < pixels; ++i)
    if (stored_number(image, i * channels + channels - 1) != 1) return true;
  return false;
}

}  // namespace

ImageContents image_contents(const std::string& path) {
  if (path.empty()) return {};
  try {
    TextureSource source{image_to_open(path)};
    source.alpha = true;
    const TexelImage image = image_library().read_texels(source);
    return {shows_normals(image), shows_alpha(image)};
  } catch (const Error&) {
    return {};  // Reading the texture says why.
  }
}

}  // namespace oktett
