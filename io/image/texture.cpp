#include "io/image/texture.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "core/math.h"
#include "io/image/library.h"
#include "io/image/mip_map.h"
#include "io/text/files.h"

namespace oktett {
namespace {

/// An image file, shared by all textures that show it.
struct TextureFile {
  TextureSource source;
  std::optional<MipMap> image{};  ///< nothing: white
  std::string problem{};
};

/// So small that float and integers hold every place that follows from them.
float bounded(float v, TextureWrap wrap) {
  if (!std::isfinite(v)) return 0;
  if (wrap == TextureWrap::clamp) return std::clamp(v, -1.0f, 2.0f);
  return wrap == TextureWrap::mirror ? v - 2 * std::floor(0.5f * v) : v - std::floor(v);
}

float bounded_change(float v) { return std::isfinite(v) ? std::clamp(v, -16.0f, 16.0f) : 0; }

/// A texture with what its rotation turns by.
struct TurnedTexture : Texture {
  explicit TurnedTexture(Texture texture)
      : Texture(std::move(texture)),
        cosine(static_cast<float>(portable::cos(double{rotation}))),
        sine(static_cast<float>(portable::sin(double{rotation}))) {}

  /// A vector of uv as the texture lays it out.
  Vec2f laid(Vec2f uv) const {
    const Vec2f scaled{uv.x * scale.x, uv.y * scale.y};
    if (rotation == 0) return scaled;
    return {cosine * scaled.x - sine * scaled.y, sine * scaled.x + cosine * scaled.y};
  }

  float cosine, sine;
};

TexturePatch patch_of(const TurnedTexture& texture, Vec2f uv, Vec2f dx, Vec2f dy) {
  const Vec2f at = texture.laid(uv), x = texture.laid(dx), y = texture.laid(dy);
  const float s = bounded(at.x + texture.offset.x, texture.lookup.u);
  const float t = bounded(at.y + texture.offset.y, texture.lookup.v);
  return {s, 1 - t, bounded_change(x.x), bounded_change(-x.y), bounded_change(y.x), bounded_change(-y.y)};
}

void load(TextureFile& file) {
  try {
    file.image.emplace(image_library().read_texels(file.source));
  } catch (const Error& error) {
    const std::string message = error.what(), place = file.source.path + ": ";
    file.problem = message.starts_with(place) ? message.substr(place.size()) : message;
  }
}

class FileTextures final : public TextureSampler {
 public:
  FileTextures(std::vector<Texture> textures, std::vector<Warning>& warnings) {
    for (Texture& texture : textures) textures_.emplace_back(std::move(texture));
    list_files();
    tbb::parallel_for(std::size_t{0}, files_.size(), [this](std::size_t i) { load(files_[i]); });
    for (const TextureFile& file : files_)
      if (!file.image)
        warnings.push_back(
            {Location{file.source.path}, "texture not used: " + file.problem + "; white instead"});
  }

  Color color(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const override {
    const MipMap* const image = image_of(index);
    if (image == nullptr) return {1, 1, 1};
    const TurnedTexture& texture = textures_[index];
    const TexturePatch patch = patch_of(texture, uv, dx, dy);
    const auto shown = [&]() -> Color {
      if (texture.channel != ImageChannel::alpha) return image->color(patch, texture.lookup);
      const float alpha = image->channel(ImageChannel::alpha, patch, texture.lookup);
      return {alpha, alpha, alpha};
    };
    return shown() * texture.gain + Color{texture.base, texture.base, texture.base};
  }

  float value(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const override {
    const MipMap* const image = image_of(index);
    if (image == nullptr) return 1;
    const TurnedTexture& texture = textures_[index];
    return image->channel(texture.channel, patch_of(texture, uv, dx, dy), texture.lookup) * texture.gain +
           texture.base;
  }

  Vec3f normal(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const override {
    const MipMap* const image = image_of(index);
    if (image == nullptr) return {0.5f, 0.5f, 1};
    const TurnedTexture& texture = textures_[index];
    return image->stored(patch_of(texture, uv, dx, dy), texture.lookup);
  }

 private:
  static constexpr std::size_t kNoFile = ~std::size_t{0};  ///< of a pattern, or white

  void list_files() {
    std::map<std::tuple<std::string, const std::string*, TextureColors>, std::size_t> known;
    for (const Texture& texture : textures_) {
      if (texture.path.empty()) {
        file_of_.push_back(kNoFile);
        continue;
      }
      const auto [place, is_new] =
          known.try_emplace({texture.path, texture.content.get(), texture.color_space}, files_.size());
      if (is_new) files_.push_back({{texture.path, texture.content, texture.color_space}});
      TextureSource& source = files_[place->second].source;
      source.alpha = source.alpha || texture.channel == ImageChannel::alpha;
      file_of_.push_back(place->second);
    }
  }

  /// Null if the texture is white.
  const MipMap* image_of(std::uint32_t index) const {
    if (index >= textures_.size() || file_of_[index] == kNoFile) return nullptr;
    const std::optional<MipMap>& image = files_[file_of_[index]].image;
    return image ? &*image : nullptr;
  }

  std::vector<TurnedTexture> textures_;
  std::vector<TextureFile> files_;
  std::vector<std::size_t> file_of_;  ///< per texture
};

}  // namespace

ImageTextures::ImageTextures(std::vector<Texture> textures) {
  std::set<std::string> refused;
  for (Texture& texture : textures) {
    if (texture.path.empty() || texture.content) continue;
    note_file_read(texture.path);
    const std::string why = why_not_an_image(texture.path);
    if (why.empty()) {
      texture.path = path_to_open(texture.path);
      continue;
    }
    if (refused.insert(texture.path).second)
      warnings_.push_back({Location{texture.path}, "texture not used: " + why + "; white instead"});
    texture.path.clear();
  }
  const auto is_image = [](const Texture& texture) { return !texture.path.empty(); };
  if (std::ranges::any_of(textures, is_image))
    sampler_ = std::make_unique<FileTextures>(std::move(textures), warnings_);
}

ImageTextures::ImageTextures(std::vector<Texture> textures, std::span<const Location> places)
    : ImageTextures(textures) {
  for (Warning& warning : warnings_)
    for (std::size_t i = 0; i < std::min(textures.size(), places.size()); ++i) {
      if (path_to_open(textures[i].path) != path_to_open(warning.where.file) || places[i].line == 0) continue;
      warning.message = "texture " + textures[i].path + warning.message.substr(std::string("texture").size());
      warning.where = places[i];
      break;
    }
}

Color ImageTextures::color(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const {
  return sampler_ ? sampler_->color(index, uv, dx, dy) : Color{1, 1, 1};
}

float ImageTextures::value(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const {
  return sampler_ ? sampler_->value(index, uv, dx, dy) : 1;
}

Vec3f ImageTextures::normal(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const {
  return sampler_ ? sampler_->normal(index, uv, dx, dy) : Vec3f{0.5f, 0.5f, 1};
}

}  // namespace oktett
