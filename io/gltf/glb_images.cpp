#include "io/gltf/glb_images.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/parallel.h"
#include "io/image/color.h"
#include "io/image/encode.h"
#include "io/image/library.h"
#include "io/image/mip_map.h"
#include "render/picture.h"

namespace oktett {
namespace {

MipMap texels_of(const Texture& texture) {
  TextureSource source{texture.path, texture.content, texture.color_space,
                       texture.channel == ImageChannel::alpha};
  if (!texture.content) source.path = image_to_open(texture.path);
  return MipMap(image_library().read_texels(source));
}

/// A picture of linear planes.
Picture planes_of(std::uint32_t width, std::uint32_t height, bool alpha) {
  Picture picture;
  picture.width = picture.full_width = width, picture.height = picture.full_height = height;
  for (const char* const name : {"R", "G", "B", "A"}) {
    if (*name == 'A' && !alpha) break;
    PicturePlane& plane = picture.planes.emplace_back();
    plane.name = name;
    plane.values.resize_uninitialized(std::size_t{width} * height);
  }
  return picture;
}

/// Calls f(patch, i) for the middle of each pixel.
template <class F>
void for_each_pixel(std::uint32_t width, std::uint32_t height, const F& f) {
  in_parts(std::size_t{width} * height, std::size_t{1} << 14, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      TexturePatch patch;
      patch.s = (static_cast<float>(i % width) + 0.5f) / static_cast<float>(width);
      patch.t = (static_cast<float>(i / width) + 0.5f) / static_cast<float>(height);
      f(patch, i);
    }
  });
}

}  // namespace

std::string png_of_texture(const Texture* color, const Texture* opacity) {
  std::optional<MipMap> colors, alphas;
  if (color != nullptr) colors.emplace(texels_of(*color));
  if (opacity != nullptr) alphas.emplace(texels_of(*opacity));
  std::uint32_t width = 1, height = 1;
  for (const std::optional<MipMap>* const map : {&colors, &alphas})
    if (*map) width = std::max(width, (*map)->size(0)[0]), height = std::max(height, (*map)->size(0)[1]);
  Picture picture = planes_of(width, height, opacity != nullptr);
  for_each_pixel(width, height, [&](const TexturePatch& patch, std::size_t i) {
    Color c{1, 1, 1};
    if (colors) c = colors->color(patch, color->lookup);
    if (alphas) {
      const float a =
          alphas->channel(opacity->channel, patch, opacity->lookup) * opacity->gain + opacity->base;
      picture.planes[3].values[i] = std::clamp(a, 0.0f, 1.0f);
      c = c * picture.planes[3].values[i];
    }
    picture.planes[0].values[i] = c.x, picture.planes[1].values[i] = c.y, picture.planes[2].values[i] = c.z;
  });
  return encode_png(picture, {});
}

std::string png_of_heights(const Texture& heights, double scale, double width, double height) {
  const MipMap map = texels_of(heights);
  const auto [columns, rows] = map.size(0);
  Picture picture = planes_of(columns, rows, false);
  const float right = 1 / static_cast<float>(columns), down = 1 / static_cast<float>(rows);
  // From a pixel on the left to one on the right, two pixels away, and so upwards.
  const double by_s = scale * double{heights.gain} / (2 * double{right} * width),
               by_t = scale * double{heights.gain} / (2 * double{down} * height);
  for_each_pixel(columns, rows, [&](const TexturePatch& patch, std::size_t i) {
    const auto at = [&](float s, float t) {
      TexturePatch moved = patch;
      moved.s += s, moved.t += t;
      return static_cast<double>(map.channel(heights.channel, moved, heights.lookup));
    };
    const Vec3d n =
        normalize(Vec3d{(at(-right, 0) - at(right, 0)) * by_s, (at(0, down) - at(0, -down)) * by_t, 1});
    // PNG files hold what is no colour, too, as if it were one.
    for (int k = 0; k < 3; ++k)
      picture.planes[static_cast<std::size_t>(k)].values[i] =
          srgb_to_linear(static_cast<float>(0.5 * n[k] + 0.5));
  });
  return encode_png(picture, {});
}

}  // namespace oktett
