#include "io/image/oiio/open_image.h"

#include <OpenImageIO/sysutil.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <string_view>
#include <system_error>

#include "core/error.h"

namespace oktett::oiio {
namespace {

constexpr int kMaxChannels = 1024;

void check_exists(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) fail(path, "no such file");
  if (status.type() == std::filesystem::file_type::directory) fail(path, "is a directory, not an image");
  if (status.type() != std::filesystem::file_type::regular) fail(path, "is not a regular file");
}

/// A header is a few bytes that can ask for any amount of memory.
void check_header(const std::string& path, const OIIO::ImageSpec& spec) {
  if (spec.deep) fail(path, "deep images are not supported");
  if (spec.depth > 1) fail(path, "volumes are not supported");
  if (spec.width <= 0 || spec.height <= 0) fail(path, "the image has no pixels");
  if (spec.nchannels <= 0 || spec.nchannels > kMaxChannels)
    fail(path, fmt::format("the image has {} channels, expected 1 to {}", spec.nchannels, kMaxChannels));
  check_size_in_memory(path, spec.width, spec.height, spec.nchannels);
}

}  // namespace

void check_size_in_memory(const std::string& path, int width, int height, int channels) {
  const double bytes = 4.0 * width * height * channels;
  // It reads /proc/meminfo, and returns 0 where there is none: unknown, as in a chroot.
  const double limit = 0.25 * static_cast<double>(OIIO::Sysutil::physical_memory());
  if (limit > 0 && bytes > limit)
    fail(path,
         fmt::format("an image of {} x {} x {} channels needs {:.1f} GB, more than a quarter of the memory",
                     width, height, channels, bytes * 1e-9));
}

void fail(const std::string& path, const std::string& message) {
  throw Error(Location{path}, message, ErrorKind::io);
}

std::string first_line(const std::string& text, const std::string& fallback) {
  std::string line = text.substr(0, text.find_first_of("\r\n"));
  while (!line.empty() && (line.back() == '.' || line.back() == ' ')) line.pop_back();
  return line.empty() ? fallback : line;
}

std::string take_image_error(const std::string& fallback) { return first_line(OIIO::geterror(), fallback); }

/// The way to Rec.709 from the primaries that the header names.
static std::optional<ColorMatrix> primaries_of(const OIIO::ImageSpec& spec) {
  Chromaticities chromaticities;
  const OIIO::TypeDesc type(OIIO::TypeDesc::FLOAT, static_cast<int>(chromaticities.size()));
  const OIIO::ParamValue* const value = spec.find_attribute("chromaticities", type);
  if (value == nullptr) return std::nullopt;
  std::memcpy(chromaticities.data(), value->data(), sizeof chromaticities);
  return to_rec709(chromaticities);
}

ColorEncoding color_encoding(const OIIO::ImageSpec& spec) {
  // Names differ between versions of the library: "sRGB" or "srgb_rec709_scene", "Linear" or "lin_rec709",
  // "Gamma2.2", "GammaCorrected2.2" or "g22_rec709".
  std::string space{spec.get_string_attribute("oiio:ColorSpace")};
  std::transform(space.begin(), space.end(), space.begin(), [](unsigned char c) { return std::tolower(c); });
  if (space.starts_with("srgb") || space == "rec709") return {TransferCurve::srgb, 1};
  if (space.starts_with("g18") || space.starts_with("g22") || space.starts_with("g24"))
    return {TransferCurve::gamma, space[1] == '1' ? 1.8f : space[2] == '2' ? 2.2f : 2.4f};
  if (space.starts_with("gamma")) {
    const std::size_t digit = space.find_first_of("0123456789");
    const float exponent = digit == std::string::npos ? 2.2f : std::strtof(space.c_str() + digit, nullptr);
    if (exponent > 0.1f && exponent < 10) return {TransferCurve::gamma, exponent};
  }
  // TIFF says nothing, of 8 bits or 16.
  if (space.empty() && !spec.format.is_floating_point()) return {TransferCurve::srgb, 1};
  ColorEncoding encoding;
  encoding.to_rec709 = primaries_of(spec);
  return encoding;
}

/// Opens the image that `memory` holds, or returns null.
static OIIO::ImageInput::unique_ptr open_memory(OIIO::Filesystem::IOMemReader& memory,
                                                const OIIO::ImageSpec& config) {
  char start[12] = {};
  memory.pread(start, sizeof start, 0);
  const std::string_view text(start, sizeof start);
  const char* format = nullptr;
  if (text.starts_with("\x89PNG")) format = "png";
  if (text.starts_with("\xff\xd8\xff")) format = "jpeg";
  if (text.starts_with("RIFF") && text.substr(8) == "WEBP") format = "webp";
  if (format == nullptr) return nullptr;
  OIIO::ImageInput::unique_ptr input = OIIO::ImageInput::create(format);
  OIIO::ImageSpec spec;
  // The name says nothing but the format: no file of it is opened.
  if (input == nullptr || !input->set_ioproxy(&memory) ||
      !input->open(std::string("image.") + format, spec, config))
    return nullptr;
  return input;
}

OIIO::ImageInput::unique_ptr open_image(const std::string& path, OIIO::Filesystem::IOMemReader* memory) {
  if (memory == nullptr) check_exists(path);
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  OIIO::ImageInput::unique_ptr input;
  try {
    input = memory != nullptr ? open_memory(*memory, config) : OIIO::ImageInput::open(path, &config);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    fail(path, "cannot read the image: " + first_line(error.what(), "damaged file"));
  }
  if (!input) fail(path, "cannot read the image: " + take_image_error("damaged file"));
  check_header(path, input->spec());
  return input;
}

bool has_silent_error(const OIIO::ImageInput& input) {
  return std::string_view(input.format_name()) == "tiff" && input.has_error();
}

bool read_pixels(OIIO::ImageInput& input, int begin, int end, OIIO::TypeDesc type, void* pixels) {
  (void)input.geterror();  // of the header
  return input.read_image(0, 0, begin, end, type, pixels) && !has_silent_error(input);
}

void read_channels(OIIO::ImageInput& input, const std::string& path, int begin, int end, OIIO::TypeDesc type,
                   void* pixels) {
  std::string why;
  try {
    if (read_pixels(input, begin, end, type, pixels)) return;
    why = input.geterror();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    why = error.what();
  }
  fail(path, "cannot read the image: " + first_line(why, "damaged file"));
}

}  // namespace oktett::oiio

/// The one symbol that the shared library shows; kImageLibraryEntry names it.
extern "C" __attribute__((visibility("default"))) const oktett::ImageLibrary* oktett_image_library();

const oktett::ImageLibrary* oktett_image_library() {
  static const oktett::oiio::OpenImageIoLibrary library;
  return &library;
}
