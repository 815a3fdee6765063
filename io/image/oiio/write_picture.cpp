#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <vector>

#include "core/error.h"
#include "io/image/oiio/open_image.h"

namespace oktett::oiio {
namespace {

using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

/// The writer for `path`'s extension, or null. Leaves out those that make no file.
ImageOutput::unique_ptr find_writer(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  ImageOutput::unique_ptr output;
  if (!extension.empty()) output = ImageOutput::create("picture" + extension);
  OIIO::geterror();
  if (output &&
      (std::strcmp(output->format_name(), "null") == 0 || std::strcmp(output->format_name(), "term") == 0))
    output.reset();
  return output;
}

struct AddTo {
  ImageSpec& spec;
  const std::string& name;

  void operator()(const Matrix4& matrix) const { spec.attribute(name, OIIO::TypeMatrix, matrix.data()); }
  void operator()(const Vec3d& v) const {
    spec.attribute(name, OIIO::TypeDesc(OIIO::TypeDesc::DOUBLE, OIIO::TypeDesc::VEC3), &v);
  }
  void operator()(const auto& value) const { spec.attribute(name, value); }
};

/// Throws Error, which names `path`, if the writer reports one. `file` is the name that it writes to, unless
/// it has a proxy.
void write_pixels(ImageOutput& output, const std::string& path, const std::string& file,
                  const FlatImage& image, const std::vector<Attribute>& attributes) {
  const bool eight_bit = image.floats.empty();
  const TypeDesc type = eight_bit ? TypeDesc::UINT8 : TypeDesc::FLOAT;
  ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height),
                 static_cast<int>(image.channels), type);
  spec.attribute("oiio:ColorSpace", eight_bit ? "sRGB" : "Linear");
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("CompressionQuality", 95);
  for (const Attribute& attribute : attributes) std::visit(AddTo{spec, attribute.name}, attribute.value);
  const void* const pixels = eight_bit ? static_cast<const void*>(image.bytes.data()) : image.floats.data();
  std::string why;
  try {
    if (output.open(file, spec) && output.write_image(type, pixels) && output.close()) return;
    why = output.geterror();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    why = error.what();
  }
  fail(path, "cannot write: " + first_line(why, "unknown reason"));
}

ImageOutput::unique_ptr require_writer(const std::string& path) {
  ImageOutput::unique_ptr writer = find_writer(path);
  if (!writer) throw Error(Location{path}, "unknown image format");
  return writer;
}

/// Whether the writer gives the bytes to a proxy that it would write to a file. That of TIFF claims to in
/// version 2.4 but leaves some out, and that of JPEG 2000 does not report its errors.
bool writes_to_memory(const ImageOutput& output) {
  const std::string format = output.format_name();
  return output.supports("ioproxy") && format != "tiff" && format != "jpeg2000";
}

/// Whether all rows of a file can be decoded and it has the size of `image`.
bool can_be_read(const std::string& file, const FlatImage& image) {
  constexpr int kRows = 64;  // at a time, so that little memory is needed
  try {
    const OIIO::ImageInput::unique_ptr input = OIIO::ImageInput::open(file);
    OIIO::geterror();
    if (input == nullptr) return false;
    (void)input->geterror();  // of the header
    const ImageSpec spec = input->spec();
    const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
    if (spec.width != width || spec.height != height) return false;
    const auto channels = static_cast<std::size_t>(spec.nchannels);
    std::vector<std::uint8_t> rows(kRows * image.width * channels);
    for (int y = 0; y < height; y += kRows)
      if (!input->read_scanlines(0, 0, y, std::min(y + kRows, height), 0, 0, spec.nchannels, TypeDesc::UINT8,
                                 rows.data()) ||
          has_silent_error(*input))
        return false;
    return true;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace

std::optional<PixelLayout> OpenImageIoLibrary::layout(const std::string& path) const {
  const ImageOutput::unique_ptr output = find_writer(path);
  if (!output) return std::nullopt;
  if (std::strcmp(output->format_name(), "hdr") == 0) return PixelLayout::float_rgb;
  return output->supports("alpha") ? PixelLayout::srgb8_alpha : PixelLayout::srgb8;
}

std::optional<std::vector<unsigned char>> OpenImageIoLibrary::encode(
    const std::string& path, const FlatImage& image, const std::vector<Attribute>& attributes) const {
  const ImageOutput::unique_ptr writer = require_writer(path);
  if (!writes_to_memory(*writer)) return std::nullopt;
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  if (!writer->set_ioproxy(&memory)) return std::nullopt;
  write_pixels(*writer, path, path, image, attributes);
  return bytes;
}

void OpenImageIoLibrary::write(const std::string& path, const std::string& temporary, const FlatImage& image,
                               const std::vector<Attribute>& attributes) const {
  write_pixels(*require_writer(path), path, temporary, image, attributes);
  // Many writers do not notice that the disk is full: they ignore what fwrite() and fclose() return. Then the
  // file ends too early, which its reader reports.
  if (!can_be_read(temporary, image))
    fail(path, "cannot write: the file cannot be read back, perhaps because the disk is full");
}

}  // namespace oktett::oiio
