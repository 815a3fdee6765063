#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/sysutil.h>
#include <OpenImageIO/texture.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <map>
#include <mutex>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "io/image/oiio/open_image.h"

namespace oktett::oiio {
namespace {

using OIIO::TextureSystem;
using OIIO::TypeDesc;

/// Set when memory ran out in the library's threads, whose exceptions end up as messages about a file.
std::atomic<bool> memory_refused{false};

/// Presents an image file to a texture cache as six channels: linear R, G, B, then the first three as
/// stored (a grey one repeated). Halves for 8-bit files, which lose nothing that 8 bits hold, floats for all
/// others. The path is handed over as the string attribute `oktett:path` of the configuration, so no
/// character of it has a meaning to the cache.
class TextureInput final : public OIIO::ImageInput {
 public:
  static constexpr int kChannels = 6;
  static constexpr int kStoredChannel = 3;  ///< the first of those as stored

  /// In the form the cache's add_file wants.
  static OIIO::ImageInput* create() { return new TextureInput; }

  const char* format_name() const override { return "oktett-texture"; }
  bool open(const std::string&, OIIO::ImageSpec&) override {
    errorfmt("a texture is opened by its configuration only");
    return false;
  }

  bool open(const std::string&, OIIO::ImageSpec& spec, const OIIO::ImageSpec& config) override {
    try {
      input_ = open_image(std::string(config.get_string_attribute("oktett:path")));
    } catch (const Error& error) {
      errorfmt("{}", error.what());
      return false;
    } catch (const std::bad_alloc&) {
      memory_refused = true;
      return false;
    }
    const OIIO::ImageSpec& file = input_->spec();
    encoding_ = color_encoding(file);
    file_channels_ = file.nchannels < 3 ? 1 : 3;
    curve_.clear();
    const bool eight_bit = file.format.basetype == TypeDesc::UINT8;
    if (eight_bit)
      for (int v = 0; v < 256; ++v) curve_.push_back(decode(encoding_, static_cast<float>(v) / 255.0f));
    m_spec =
        OIIO::ImageSpec(file.width, file.height, kChannels, eight_bit ? TypeDesc::HALF : TypeDesc::FLOAT);
    spec = m_spec;
    return true;
  }

  bool close() override {
    input_.reset();
    pixels_ = {};
    return true;
  }

  bool read_native_scanline(int subimage, int miplevel, int y, int z, void* data) override {
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

 private:
  /// Decodes the whole file: it may be compressed in a way that has no rows.
  bool read_pixels() {
    const std::size_t count = static_cast<std::size_t>(m_spec.width) *
                              static_cast<std::size_t>(m_spec.height) *
                              static_cast<std::size_t>(file_channels_);
    std::string why;
    try {
      pixels_.resize(count);
      if (input_->read_image(0, 0, 0, file_channels_, TypeDesc::FLOAT, pixels_.data())) return true;
      why = input_->geterror();
    } catch (const std::bad_alloc&) {
      memory_refused = true;
    } catch (const std::exception& error) {
      why = error.what();
    }
    pixels_ = {};
    errorfmt("cannot read the image: {}", first_line(why, "damaged file"));
    return false;
  }

  void decode_row(int y, float* row) const {
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

  OIIO::ImageInput::unique_ptr input_;
  ColorEncoding encoding_;
  std::vector<float> curve_;   ///< decoded value of each 8-bit number; empty for other types
  std::vector<float> pixels_;  ///< the file's channels, from the first row read to the last
  int file_channels_ = 0;
};

/// The one texture system of the process, with a cache of its own. It lives until the process ends:
/// version 2.4 of the library frees it in a way that memory checkers refuse.
TextureSystem& texture_system() {
  static const auto* const system = [] {
    const auto* created = new auto(TextureSystem::create(false));
    (*created)->attribute("automip", 1);
    (*created)->attribute("autotile", 0);
    (*created)->attribute("deduplicate", 0);
    (*created)->attribute("max_tile_channels", TextureInput::kChannels);
    return created;
  }();
  return **system;
}

/// The cache must hold everything at once: an image that is dropped costs a whole decoding to bring back.
void reserve_memory(double bytes) {
  static std::mutex mutex;
  static double total = 64e6;
  const std::lock_guard lock(mutex);
  total += bytes;
  const double limit = 0.5 * static_cast<double>(OIIO::Sysutil::physical_memory());
  texture_system().attribute("max_memory_MB", static_cast<float>(std::min(total, limit) / (1 << 20)));
}

/// A name that no other image of the process has had.
OIIO::ustring new_name() {
  static std::atomic<std::uint64_t> counter{0};
  return OIIO::ustring("oktett-texture-" + std::to_string(counter++));
}

/// An image file, shared by all textures that show it.
struct ImageFile {
  std::string path;
  TextureSystem::TextureHandle* handle = nullptr;  ///< null: white
  OIIO::ustring name;                              ///< in the cache
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
    const OIIO::ImageSpec spec = open_image(file.path)->spec();
    const double channel_bytes = spec.format.size() == 1 ? 2 : 4;
    file.bytes = TextureInput::kChannels * channel_bytes * spec.width * spec.height * 4 / 3;
  } catch (const Error& error) {
    const std::string message = error.what();
    const std::string place = file.path + ": ";
    file.problem = message.starts_with(place) ? message.substr(place.size()) : message;
  }
}

/// Brings the finest level into the cache, which is also how damage beyond the header is found.
void load(ImageFile& file) {
  TextureSystem& system = texture_system();
  file.name = new_name();
  OIIO::ImageSpec config;
  config.attribute("oktett:path", file.path);
  system.imagecache()->add_file(file.name, &TextureInput::create, &config);
  TextureSystem::TextureHandle* handle = system.get_texture_handle(file.name);
  float texel[TextureInput::kChannels];
  OIIO::TextureOpt options = lookup_options(true, 0);
  if (handle != nullptr && system.good(handle) &&
      system.texture(handle, nullptr, options, 0.5f, 0.5f, 0, 0, 0, 0, TextureInput::kChannels, texel)) {
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
    memory_refused = false;
    tbb::parallel_for(std::size_t{0}, files_.size(), [this](std::size_t i) {
      if (files_[i].problem.empty()) load(files_[i]);
    });
    if (memory_refused) throw std::bad_alloc();
    for (const ImageFile& file : files_)
      if (file.handle == nullptr)
        warnings.push_back({Location{file.path}, "texture not used: " + file.problem + "; white instead"});
  }
  ~FileTextures() override {
    for (const ImageFile& file : files_)
      if (!file.name.empty()) texture_system().invalidate(file.name);
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
    if (!look_up(index, uv, dx, dy, TextureInput::kStoredChannel, 1, &texel)) return 1;
    return texel * textures_[index].gain + textures_[index].base;
  }

  Vec3f normal(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const override {
    float xyz[3];
    if (!look_up(index, uv, dx, dy, TextureInput::kStoredChannel, 3, xyz)) return {0.5f, 0.5f, 1};
    return {xyz[0], xyz[1], xyz[2]};
  }

 private:
  static constexpr std::size_t kNoFile = ~std::size_t{0};  ///< of a pattern, or white

  void list_files() {
    std::map<std::string, std::size_t> known;
    for (const Texture& texture : textures_) {
      if (texture.path.empty()) {
        file_of_.push_back(kNoFile);
        continue;
      }
      const auto [place, is_new] = known.try_emplace(texture.path, files_.size());
      if (is_new) files_.push_back({texture.path, nullptr, {}, {}, 0});
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
