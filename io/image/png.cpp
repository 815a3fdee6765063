#include <png.h>

#include <csetjmp>
#include <exception>
#include <new>
#include <string>
#include <utility>

#include "core/error.h"
#include "io/image/encode.h"

namespace oktett {
namespace {

/// zlib's Z_DEFAULT_STRATEGY makes files a tenth smaller than what libpng chooses, in the same time.
constexpr int kStrategy = 0;
/// Takes half the time of zlib's usual level 6, for files that are 2 to 16 % larger.
constexpr int kDeflateLevel = 4;

/// The state of libpng for one picture. No exception may pass through libpng, which is C code. Instead, a
/// callback keeps the error here and jumps back to try_to_write().
class PngWriter {
 public:
  PngWriter() {
    png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, this, keep_error, [](png_structp, const char*) {});
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr) {
      png_destroy_write_struct(&png_, nullptr);
      throw std::bad_alloc();
    }
    png_set_write_fn(png_, this, write_bytes, [](png_structp) {});
  }
  ~PngWriter() { png_destroy_write_struct(&png_, &info_); }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;

  std::string encode(const FlatImage& image, const std::vector<png_text>& texts) {
    if (!try_to_write(image, texts)) std::rethrow_exception(failure_);
    return std::move(bytes_);
  }

 private:
  /// False after an error. The jump skips no destructor: neither this function nor the callbacks have objects
  /// that need one then.
  bool try_to_write(const FlatImage& image, const std::vector<png_text>& texts) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_compression_strategy(png_, kStrategy);
    png_set_compression_level(png_, kDeflateLevel);
    const bool words = !image.words.empty(), grey = image.channels == 1;
    png_set_IHDR(png_, info_, image.width, image.height, words ? 16 : 8,
                 grey                  ? PNG_COLOR_TYPE_GRAY
                 : image.channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA
                                       : PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (grey)
      png_set_gAMA_fixed(png_, info_, PNG_FP_1);
    else
      png_set_sRGB_gAMA_and_cHRM(png_, info_, PNG_sRGB_INTENT_ABSOLUTE);
    png_set_text(png_, info_, texts.data(), static_cast<int>(texts.size()));
    png_write_info(png_, info_);
    // PNG stores the greater byte first.
    if (words) png_set_swap(png_);
    const std::size_t row_numbers = std::size_t{image.width} * image.channels;
    for (std::size_t row = 0; row < image.height; ++row)
      png_write_row(png_, words ? reinterpret_cast<png_const_bytep>(&image.words[row * row_numbers])
                                : &image.bytes[row * row_numbers]);
    png_write_end(png_, nullptr);
    return true;
  }

  static void write_bytes(png_structp png, png_bytep bytes, std::size_t count) {
    auto& self = *static_cast<PngWriter*>(png_get_io_ptr(png));
    try {
      self.bytes_.append(reinterpret_cast<const char*>(bytes), count);
      return;
    } catch (...) {
      self.failure_ = std::current_exception();
    }
    png_longjmp(png, 1);
  }

  static void keep_error(png_structp png, const char* message) {
    auto& failure = static_cast<PngWriter*>(png_get_error_ptr(png))->failure_;
    failure = std::make_exception_ptr(Error(std::string("cannot write the PNG: ") + message, ErrorKind::io));
    png_longjmp(png, 1);
  }

  std::string bytes_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::exception_ptr failure_;
};

}  // namespace

static std::string encode_flat(const FlatImage& image, const std::vector<Attribute>& attributes) {
  std::vector<png_text> texts;
  for (const Attribute& attribute : attributes)
    if (const auto* text = std::get_if<std::string>(&attribute.value)) {
      // libpng only reads the texts, but its pointers are not to const.
      png_text& entry = texts.emplace_back();
      entry.compression = PNG_TEXT_COMPRESSION_NONE;
      entry.key = const_cast<char*>(attribute.name.c_str());
      entry.text = const_cast<char*>(text->c_str());
    }
  return PngWriter().encode(image, texts);
}

std::string encode_png(const Picture& picture, const std::vector<Attribute>& attributes) {
  return encode_flat(flatten(picture, PixelLayout::srgb8_alpha), attributes);
}

void write_png(OutputFile& file, const Picture& picture, const std::vector<Attribute>& attributes) {
  file.write(encode_png(picture, attributes));
}

void write_png(OutputFile& file, const FlatImage& image, const std::vector<Attribute>& attributes) {
  file.write(encode_flat(image, attributes));
}

}  // namespace oktett
