#include <OpenImageIO/texture.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "io/image/oiio/open_image.h"
#include "io/image/oiio/texture_cache.h"

namespace oktett::oiio {
namespace {

using OIIO::TextureSystem;

/// An image file, shared by all textures that show it.
struct ImageFile {
  ImageSource source;
  TextureSystem::TextureHandle* handle = nullptr;  ///< null: white
  int entry = -1;                                  ///< in the texture cache; -1: none
  std::string problem;
  double bytes = 0;  ///< in the cache, with all its levels
};

/// Where to look in an image, in the image's own coordinates: s to the right, t down.
struct Footprint {
  float s = 0, t = 0, dsdx = 0, dtdx = 0, dsdy = 0, dtdy = 0;
};

/// Large coordinates must not overflow the library's integers, and there is nothing to see beyond a clamped
/// edge.
float bounded(float v, bool clamp) {
  if (!std::isfinite(v)) return 0;
  return clamp ? std::clamp(v, -1.0f, 2.0f) : v - std::floor(v);
}

float bounded_change(float v) { return std::isfinite(v) ? std::clamp(v, -16.0f, 16.0f) : 0; }

Footprint footprint(const Texture& texture, Vec2f uv, Vec2f dx, Vec2f dy) {
  const float s = bounded(uv.x * texture.scale.x + texture.offset.x, texture.clamp);
  const float t = bounded(uv.y * texture.scale.y + texture.offset.y, texture.clamp);
  return {s,
          1 - t,
          bounded_change(dx.x * texture.scale.x),
          bounded_change(-dx.y * texture.scale.y),
          bounded_change(dy.x * texture.scale.x),
          bounded_change(-dy.y * texture.scale.y)};
}

OIIO::TextureOpt lookup_options(bool clamp, int first_channel) {
  OIIO::TextureOpt options;
  // The enumerations of this structure differ between versions of the library; their values do not.
  const auto wrap = clamp ? OIIO::Tex::Wrap::Clamp : OIIO::Tex::Wrap::Periodic;
  options.swrap = static_cast<decltype(options.swrap)>(wrap);
  options.twrap = static_cast<decltype(options.twrap)>(wrap);
  options.mipmode = static_cast<decltype(options.mipmode)>(OIIO::Tex::MipMode::Aniso);
  options.interpmode = static_cast<decltype(options.interpmode)>(OIIO::Tex::InterpMode::Bilinear);
  options.anisotropic = 16;
  options.firstchannel = first_channel;
  return options;
}

/// Reads the header only.
void inspect(ImageFile& file) {
  try {
    const OIIO::ImageSpec spec = OpenedImage(file.source).input->spec();
    const double channel_bytes = spec.format.size() == 1 ? 2 : 4;
    file.bytes = file.source.channels() * channel_bytes * spec.width * spec.height * 4 / 3;
  } catch (const Error& error) {
    const std::string message = error.what();
    const std::string place = file.source.path + ": ";
    file.problem = message.starts_with(place) ? message.substr(place.size()) : message;
  }
}

/// Brings the finest level into the cache, which is also how damage beyond the header is found.
void load(ImageFile& file) {
  TextureSystem& system = texture_system();
  file.entry = add_to_cache(file.source);
  TextureSystem::TextureHandle* handle = system.get_texture_handle(entry_name(file.entry));
  float texel[kMostTextureChannels];
  OIIO::TextureOpt options = lookup_options(true, 0);
  if (handle != nullptr && system.good(handle) &&
      system.texture(handle, nullptr, options, 0.5f, 0.5f, 0, 0, 0, 0, file.source.channels(), texel)) {
    file.handle = handle;
  } else {
    file.problem = first_line(system.geterror(), "cannot read the image: damaged file");
  }
}

class FileTextures final : public TextureSampler {
 public:
  FileTextures(std::vector<Texture> textures, std::vector<Warning>& warnings)
      : textures_(std::move(textures)) {
    list_files();
    double bytes = 0;
    for (ImageFile& file : files_) {
      inspect(file);
      bytes += file.bytes;
    }
    reserve_memory(bytes);
    forget_refused_memory();
    tbb::parallel_for(std::size_t{0}, files_.size(), [this](std::size_t i) {
      if (files_[i].problem.empty()) load(files_[i]);
    });
    if (memory_was_refused()) throw std::bad_alloc();
    for (const ImageFile& file : files_)
      if (file.handle == nullptr)
        warnings.push_back(
            {Location{file.source.path}, "texture not used: " + file.problem + "; white instead"});
  }
  ~FileTextures() override {
    for (const ImageFile& file : files_)
      if (file.entry >= 0) remove_from_cache(file.entry);
    double bytes = 0;
    for (const ImageFile& file : files_) bytes += file.bytes;
    reserve_memory(-bytes);
  }
  FileTextures(const FileTextures&) = delete;
  FileTextures& operator=(const FileTextures&) = delete;

  Color color(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const override {
    float rgb[3];
    if (!look_up(index, uv, dx, dy, 0, 3, rgb)) return {1, 1, 1};
    const Texture& texture = textures_[index];
    return Color{rgb[0], rgb[1], rgb[2]} * texture.gain + Color{texture.base, texture.base, texture.base};
  }

  float value(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const override {
    float texel;
    if (index >= textures_.size()) return 1;
    const int channel = kStoredChannel + static_cast<int>(textures_[index].channel);
    if (!look_up(index, uv, dx, dy, channel, 1, &texel)) return 1;
    return texel * textures_[index].gain + textures_[index].base;
  }

  Vec3f normal(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const override {
    float xyz[3];
    if (!look_up(index, uv, dx, dy, kStoredChannel, 3, xyz)) return {0.5f, 0.5f, 1};
    return {xyz[0], xyz[1], xyz[2]};
  }

 private:
  static constexpr std::size_t kNoFile = ~std::size_t{0};  ///< of a pattern, or white

  void list_files() {
    std::map<std::pair<std::string, const std::string*>, std::size_t> known;
    for (const Texture& texture : textures_) {
      if (texture.path.empty()) {
        file_of_.push_back(kNoFile);
        continue;
      }
      const auto [place, is_new] = known.try_emplace({texture.path, texture.content.get()}, files_.size());
      if (is_new) files_.push_back({{texture.path, texture.content}, nullptr, -1, {}, 0});
      ImageSource& source = files_[place->second].source;
      source.alpha = source.alpha || texture.channel == ImageChannel::alpha;
      file_of_.push_back(place->second);
    }
  }

  /// False if the texture is white.
  bool look_up(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy, int first_channel, int channels,
               float* result) const {
    if (index >= textures_.size() || file_of_[index] == kNoFile) return false;
    const Texture& texture = textures_[index];
    TextureSystem::TextureHandle* handle = files_[file_of_[index]].handle;
    if (handle == nullptr) return false;
    const Footprint at = footprint(texture, uv, dx, dy);
    OIIO::TextureOpt options = lookup_options(texture.clamp, first_channel);
    return texture_system().texture(handle, nullptr, options, at.s, at.t, at.dsdx, at.dtdx, at.dsdy, at.dtdy,
                                    channels, result);
  }

  std::vector<Texture> textures_;
  std::vector<ImageFile> files_;
  std::vector<std::size_t> file_of_;  ///< per texture
};

}  // namespace

std::unique_ptr<TextureSampler> OpenImageIoLibrary::load_textures(std::vector<Texture> textures,
                                                                  std::vector<Warning>& warnings) const {
  return std::make_unique<FileTextures>(std::move(textures), warnings);
}

}  // namespace oktett::oiio
