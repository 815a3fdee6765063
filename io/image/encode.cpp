#include "io/image/encode.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/math.h"
#include "core/parallel.h"
#include "io/image/byte_table.h"
#include "io/image/color.h"

namespace oktett {
namespace {

/// Pixels that a task turns into bytes.
constexpr std::size_t kPixelsOfPart = std::size_t{1} << 14;

const PicturePlane& color_plane(const Picture& picture, const char* name) {
  const PicturePlane* plane = picture.find(name);
  if (plane == nullptr || plane->type == PlaneType::unsigned_int)
    throw Error(fmt::format("the picture has no colour plane {}, which this format needs", name));
  return *plane;
}

std::array<const PicturePlane*, 3> color_planes(const Picture& picture) {
  return {&color_plane(picture, "R"), &color_plane(picture, "G"), &color_plane(picture, "B")};
}

/// Coverage in [0, 1]; NaN and infinities count as none.
float clamped_alpha(float a) { return std::isfinite(a) ? std::clamp(a, 0.0f, 1.0f) : 0; }

/// `shown(light)`: the number of each colour; `most`: that of 1.
template <class T, class Shown>
FlatImage flatten_to_srgb(const Picture& picture, bool with_alpha, std::vector<T> FlatImage::*numbers,
                          const Shown& shown, float most) {
  const std::array<const PicturePlane*, 3> planes = color_planes(picture);
  const PicturePlane* alpha = with_alpha ? &color_plane(picture, "A") : nullptr;
  const std::uint32_t channels = with_alpha ? 4 : 3;
  const std::size_t pixels = std::size_t{picture.width} * picture.height;
  FlatImage image{picture.width, picture.height, channels, {}, {}};
  (image.*numbers).resize(pixels * channels);
  in_parts(pixels, kPixelsOfPart, [&](std::size_t begin, std::size_t end) {
    T* out = (image.*numbers).data() + begin * channels;
    for (std::size_t i = begin; i < end; ++i) {
      const float a = alpha != nullptr ? clamped_alpha(alpha->values[i]) : 1;
      // Without coverage there is no colour to recover; what light there is (a glow) is kept as it is.
      const float divisor = a > 0 ? a : 1;
      const Color light{planes[0]->values[i] / divisor, planes[1]->values[i] / divisor,
                        planes[2]->values[i] / divisor};
      for (const T number : shown(light)) *out++ = number;
      if (alpha != nullptr) *out++ = static_cast<T>(a * most + 0.5f);
    }
  });
  return image;
}

/// The numbers of colours as a tone shows them.
template <class T>
auto shown_by(const Tone& tone, T (*encoded)(float linear)) {
  return [&tone, encoded](const Color& light) {
    const Color c = toned(tone, light);
    return std::array<T, 3>{encoded(c.x), encoded(c.y), encoded(c.z)};
  };
}

/// Whether a tone is a power of each colour for itself that ByteTable<15> can hold with sRGB's curve.
bool is_power(const Tone& tone) {
  return tone.kind == ToneKind::srgb && tone.exposure == 0 && tone.gamma > 1 && tone.gamma <= 2.25;
}

/// Each number for itself.
template <class ByteOf>
FlatImage flatten_by(const Picture& picture, bool with_alpha, const ByteOf& byte) {
  const auto shown = [&](const Color& light) -> std::array<std::uint8_t, 3> {
    // A colour that is not finite has no tone.
    if (!is_finite(light))
      return {linear_to_srgb8(light.x), linear_to_srgb8(light.y), linear_to_srgb8(light.z)};
    return {byte(light.x), byte(light.y), byte(light.z)};
  };
  return flatten_to_srgb(picture, with_alpha, &FlatImage::bytes, shown, 255);
}

FlatImage flatten_to_bytes(const Picture& picture, bool with_alpha) {
  const Tone& tone = picture.tone;
  if (tone.kind == ToneKind::raw && tone.gamma == 1) {
    const float factor = static_cast<float>(portable::exp2(tone.exposure));
    return flatten_by(picture, with_alpha, [&](float x) {
      return static_cast<std::uint8_t>(std::clamp(x * factor, 0.0f, 1.0f) * 255 + 0.5f);
    });
  }
  if (is_power(tone))
    return flatten_by(picture, with_alpha, ByteTable<15>([&](float x) {
                        return linear_to_srgb8(toned(tone, {x, x, x}).x);
                      }));
  return flatten_to_srgb(picture, with_alpha, &FlatImage::bytes, shown_by(tone, linear_to_srgb8), 255);
}

}  // namespace

FlatImage flatten(const Picture& picture, PixelLayout layout) {
  const bool with_alpha = layout != PixelLayout::srgb8 && picture.find("A") != nullptr;
  if (layout == PixelLayout::srgb16_alpha)
    return flatten_to_srgb(picture, with_alpha, &FlatImage::words, shown_by(picture.tone, linear_to_srgb16),
                           65535);
  if (layout != PixelLayout::float_rgb) return flatten_to_bytes(picture, with_alpha);
  const std::array<const PicturePlane*, 3> planes = color_planes(picture);
  const std::size_t pixels = std::size_t{picture.width} * picture.height;
  FlatImage image{picture.width, picture.height, 3, {}, {}};
  image.floats.reserve(pixels * 3);
  for (std::size_t i = 0; i < pixels; ++i)
    for (const PicturePlane* plane : planes)
      image.floats.push_back(std::isfinite(plane->values[i]) ? plane->values[i] : 0);
  return image;
}

std::vector<Attribute> attributes(const ImageMetadata& metadata) {
  std::vector<Attribute> all;
  if (!metadata.software.empty()) all.push_back({"Software", metadata.software});
  if (!metadata.command_line.empty()) all.push_back({"commandLine", metadata.command_line});
  if (!metadata.scene.empty()) all.push_back({"scene", metadata.scene});
  if (metadata.samples > 0) all.push_back({"samples", static_cast<std::int32_t>(metadata.samples)});
  if (metadata.render_seconds > 0)
    all.push_back({"renderSeconds", static_cast<float>(metadata.render_seconds)});
  if (metadata.camera) {
    all.push_back({"worldToCamera", metadata.camera->world_to_camera});
    all.push_back({"worldToNDC", metadata.camera->world_to_ndc});
  }
  if (!(metadata.origin == Vec3d{})) all.push_back({"origin", metadata.origin});
  return all;
}

}  // namespace oktett
