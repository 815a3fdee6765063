#include "io/image/oiio/texture_cache.h"

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/sysutil.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/image/oiio/open_image.h"

namespace oktett::oiio {
namespace {

using OIIO::TypeDesc;

std::atomic<bool> memory_refused{false};

/// The image file of each entry of the cache.
class Entries {
 public:
  /// An entry that no image uses, and whether it is a new one.
  std::pair<int, bool> take(const ImageSource& source) {
    const std::lock_guard lock(mutex_);
    const bool is_new = free_.empty();
    if (is_new) {
      free_.push_back(static_cast<int>(sources_.size()));
      sources_.emplace_back();
    }
    const int entry = free_.back();
    free_.pop_back();
    sources_[static_cast<std::size_t>(entry)] = source;
    return {entry, is_new};
  }

  /// From now on the entry has no file.
  void clear(int entry) {
    const std::lock_guard lock(mutex_);
    sources_[static_cast<std::size_t>(entry)] = {};
  }

  /// Others may take the entry.
  void release(int entry) {
    const std::lock_guard lock(mutex_);
    free_.push_back(entry);
  }

  /// Without a path if there is none.
  ImageSource source(int entry) const {
    const std::lock_guard lock(mutex_);
    const bool known = entry >= 0 && static_cast<std::size_t>(entry) < sources_.size();
    return known ? sources_[static_cast<std::size_t>(entry)] : ImageSource{};
  }

 private:
  mutable std::mutex mutex_;
  std::vector<ImageSource> sources_;
  std::vector<int> free_;
};

Entries& entries() {
  static Entries all;
  return all;
}

/// Presents an image file to a texture cache as channels: linear R, G, B, then the first three as
/// stored (a grey one repeated), and alpha if it is needed. Halves for 8-bit files, which lose nothing that 8
/// bits hold, floats for all others. The number of the entry is handed over as the attribute `oktett:entry`
/// of the configuration, so no character of a path has a meaning to the cache.
class TextureInput final : public OIIO::ImageInput {
 public:
  /// In the form the cache's add_file wants.
  static OIIO::ImageInput* create() { return new TextureInput; }

  const char* format_name() const override { return "oktett-texture"; }
  bool open(const std::string&, OIIO::ImageSpec&) override {
    errorfmt("a texture is opened by its configuration only");
    return false;
  }

  bool open(const std::string&, OIIO::ImageSpec& spec, const OIIO::ImageSpec& config) override {
    const ImageSource source = entries().source(config.get_int_attribute("oktett:entry", -1));
    if (source.path.empty()) {
      errorfmt("the image is no longer in use");
      return false;
    }
    try {
      opened_.emplace(source);
    } catch (const Error& error) {
      errorfmt("{}", error.what());
      return false;
    } catch (const std::bad_alloc&) {
      memory_refused = true;
      return false;
    }
    const OIIO::ImageSpec& file = opened_->input->spec();
    encoding_ = color_encoding(file);
    colors_ = file.nchannels < 3 ? 1 : 3;
    alpha_ = source.alpha ? file.alpha_channel : -1;
    stored_ = static_cast<std::size_t>(std::max(colors_, alpha_ + 1));
    curve_.clear();
    const bool eight_bit = file.format.basetype == TypeDesc::UINT8;
    if (eight_bit)
      for (int v = 0; v < 256; ++v) curve_.push_back(decode(encoding_, static_cast<float>(v) / 255.0f));
    m_spec = OIIO::ImageSpec(file.width, file.height, source.channels(),
                             eight_bit ? TypeDesc::HALF : TypeDesc::FLOAT);
    spec = m_spec;
    return true;
  }

  bool close() override {
    opened_.reset();
    pixels_ = {};
    return true;
  }

  bool read_native_scanline(int subimage, int miplevel, int y, int z, void* data) override {
    if (!opened_ || subimage != 0 || miplevel != 0 || z != 0 || y < 0 || y >= m_spec.height) return false;
    if (pixels_.empty() && !read_pixels()) return false;
    std::vector<float> row(static_cast<std::size_t>(m_spec.width) *
                           static_cast<std::size_t>(m_spec.nchannels));
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
    const std::size_t count =
        static_cast<std::size_t>(m_spec.width) * static_cast<std::size_t>(m_spec.height) * stored_;
    std::string why;
    try {
      pixels_.resize(count);
      OIIO::ImageInput& input = *opened_->input;
      if (oiio::read_pixels(input, 0, static_cast<int>(stored_), TypeDesc::FLOAT, pixels_.data()))
        return true;
      why = input.geterror();
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
    const float* in = pixels_.data() + static_cast<std::size_t>(y) * width * stored_;
    for (std::size_t x = 0; x < width; ++x, in += stored_, row += m_spec.nchannels) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float v = in[colors_ == 3 ? c : 0];
        row[c] = curve_.empty() ? decode(encoding_, v) : curve_[static_cast<std::uint8_t>(v * 255.0f + 0.5f)];
        row[kStoredChannel + c] = v;
      }
      if (m_spec.nchannels == kMostTextureChannels)
        row[kMostTextureChannels - 1] = alpha_ < 0 ? 1 : in[alpha_];
    }
  }

  std::optional<OpenedImage> opened_;
  ColorEncoding encoding_;
  std::vector<float> curve_;   ///< decoded value of each 8-bit number; empty for other types
  std::vector<float> pixels_;  ///< the file's channels, from the first row read to the last
  int colors_ = 0;             ///< 1 or 3
  int alpha_ = -1;          ///< number of the alpha channel in the file; -1: it has none, or none is needed
  std::size_t stored_ = 0;  ///< channels that are read, from the first one on
};

}  // namespace

OIIO::TextureSystem& texture_system() {
  static const auto* const system = [] {
    const auto* created = new auto(OIIO::TextureSystem::create(false));
    (*created)->attribute("automip", 1);
    (*created)->attribute("autotile", 0);
    (*created)->attribute("deduplicate", 0);
    (*created)->attribute("max_tile_channels", kMostTextureChannels);
    return created;
  }();
  return **system;
}

void reserve_memory(double bytes) {
  static std::mutex mutex;
  static double total = 64e6;
  const std::lock_guard lock(mutex);
  total += bytes;
  const double limit = 0.5 * static_cast<double>(OIIO::Sysutil::physical_memory());
  texture_system().attribute("max_memory_MB", static_cast<float>(std::min(total, limit) / (1 << 20)));
}

OpenedImage::OpenedImage(const ImageSource& source) : content(source.content) {
  if (content != nullptr)
    memory =
        std::make_unique<OIIO::Filesystem::IOMemReader>(const_cast<char*>(content->data()), content->size());
  input = open_image(source.path, memory.get());
}

int add_to_cache(const ImageSource& source) {
  const auto [entry, is_new] = entries().take(source);
  if (is_new) {
    OIIO::ImageSpec config;
    config.attribute("oktett:entry", entry);
    texture_system().imagecache()->add_file(entry_name(entry), &TextureInput::create, &config);
  } else {
    // Opens the entry anew, which now has another file.
    texture_system().invalidate(entry_name(entry));
  }
  return entry;
}

void remove_from_cache(int entry) {
  entries().clear(entry);
  // This opens the entry anew too; that fails, because it has no file any more.
  texture_system().invalidate(entry_name(entry));
  (void)texture_system().geterror();
  entries().release(entry);
}

OIIO::ustring entry_name(int entry) { return OIIO::ustring("oktett-texture-" + std::to_string(entry)); }

bool memory_was_refused() { return memory_refused; }
void forget_refused_memory() { memory_refused = false; }

}  // namespace oktett::oiio
