#include <fmt/format.h>
#include <png.h>
#include <unistd.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "io/image/heights.h"
#include "io/image/library.h"
#include "io/text/file_content.h"
#include "io/text/files.h"

namespace oktett {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kPngBeginning = "\x89PNG\r\n\x1a\n"sv;
/// Where the first chunk, which must be the header, says how colours are meant.
constexpr std::size_t kTypeOfChunk = 12, kColorType = 25;

bool begins_as_png(std::string_view text) { return text.starts_with(kPngBeginning); }

/// The bytes of a quarter of this machine's memory; no limit where that is unknown.
double most_memory() {
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
  if (pages <= 0 || size <= 0) return std::numeric_limits<double>::infinity();
  return 0.25 * static_cast<double>(pages) * static_cast<double>(size);
}

/// The state of libpng for one file. No exception may pass through libpng, which is C code. Instead, a
/// callback keeps the error here and jumps back to the function that called libpng.
class PaletteReader {
 public:
  explicit PaletteReader(std::string_view file) : rest_(file) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, keep_error, [](png_structp, const char*) {});
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png_, this, read_bytes);
  }
  ~PaletteReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PaletteReader(const PaletteReader&) = delete;
  PaletteReader& operator=(const PaletteReader&) = delete;

  // Both return false after an error, whose text is in `problem`. The jump skips no destructor: neither they
  // nor the callbacks have objects that need one then.

  /// Reads all that stands before the pixels, and fills in the numbers below.
  bool read_header() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_read_info(png_, info_);
    width = png_get_image_width(png_, info_), height = png_get_image_height(png_, info_);
    indexed = png_get_color_type(png_, info_) == PNG_COLOR_TYPE_PALETTE;
    png_colorp palette = nullptr;
    if (indexed) png_get_PLTE(png_, info_, &palette, &colors);
    return true;
  }

  /// Reads the pixels, a byte each, into width x height bytes, row by row from the top.
  bool read_pixels(unsigned char* pixels) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_packing(png_);
    // Colours that the palette lacks are found afterwards, with their place.
    png_set_check_for_invalid_index(png_, 0);
    const int passes = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    if (png_get_rowbytes(png_, info_) != width) png_error(png_, "a row has an unexpected length");
    for (int pass = 0; pass < passes; ++pass)
      for (std::size_t row = 0; row < height; ++row) png_read_row(png_, pixels + row * width, nullptr);
    png_read_end(png_, nullptr);
    return true;
  }

  std::uint32_t width = 0, height = 0;
  int colors = 0;  ///< how many the palette has
  bool indexed = false;
  char problem[200] = "";

 private:
  static void read_bytes(png_structp png, png_bytep bytes, std::size_t count) {
    auto& rest = static_cast<PaletteReader*>(png_get_io_ptr(png))->rest_;
    if (rest.size() < count) png_error(png, "the file ends too early");
    std::memcpy(bytes, rest.data(), count);
    rest.remove_prefix(count);
  }

  static void keep_error(png_structp png, const char* message) {
    char(&problem)[200] = static_cast<PaletteReader*>(png_get_error_ptr(png))->problem;
    std::strncpy(problem, message, sizeof problem - 1);
    png_longjmp(png, 1);
  }

  std::string_view rest_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

[[noreturn]] void refuse(const std::string& path, const std::string& message) {
  throw Error(Location{path}, message, ErrorKind::io);
}

void check_palette_size(const std::string& path, const PaletteReader& reader, std::uint32_t most_side,
                        std::size_t most_pixels) {
  const std::size_t width = reader.width, height = reader.height;
  const std::string found = fmt::format("the image has {} x {} pixels, expected ", width, height);
  if (std::min(width, height) < 2 || std::max(width, height) > most_side)
    refuse(path, fmt::format("{}2 to {} along each side", found, most_side));
  if (width * height > most_pixels) refuse(path, fmt::format("{}at most {} in all", found, most_pixels));
  const double bytes = static_cast<double>(width * height) * (1 + sizeof(float));
  if (bytes > most_memory())
    refuse(path,
           fmt::format("the heights of {} x {} pixels need {:.1f} GB, more than a quarter of the memory",
                       width, height, bytes * 1e-9));
}

}  // namespace

bool has_palette(const std::string& path) {
  if (!why_not_an_image(path).empty()) return false;
  const MappedFile file(path_to_open(path));
  const std::string_view text = file.text();
  return begins_as_png(text) && text.size() > kColorType && text.substr(kTypeOfChunk, 4) == "IHDR" &&
         text[kColorType] == PNG_COLOR_TYPE_PALETTE;
}

HeightImage read_palette_heights(const std::string& path, std::uint32_t most_side, std::size_t most_pixels) {
  const MappedFile file(image_to_open(path));
  if (!begins_as_png(file.text())) refuse(path, "is no PNG image, of which alone palettes are read");
  PaletteReader reader(file.text());
  if (!reader.read_header()) refuse(path, fmt::format("cannot read the image: {}", reader.problem));
  if (!reader.indexed) refuse(path, "the image has no palette");
  check_palette_size(path, reader, most_side, most_pixels);
  Column<unsigned char> numbers(std::size_t{reader.width} * reader.height);
  if (!reader.read_pixels(numbers.data()))
    refuse(path, fmt::format("cannot read the image: {}", reader.problem));
  HeightImage image;
  image.columns = reader.width, image.rows = reader.height;
  image.floats.resize_uninitialized(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] >= reader.colors)
      refuse(path, fmt::format("pixel ({}, {}) has the colour {} of a palette of {}", i % image.columns,
                               i / image.columns, numbers[i], reader.colors));
    image.floats[i] = static_cast<float>(numbers[i]) / 256;
  }
  return image;
}

}  // namespace oktett
