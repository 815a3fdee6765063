#include <OpenImageIO/imageio.h>

#include <cstring>
#include <filesystem>

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
  void operator()(const auto& value) const { spec.attribute(name, value); }
};

bool write_pixels(ImageOutput& output, const std::string& file, const FlatImage& image,
                  const std::vector<Attribute>& attributes) {
  const bool eight_bit = image.floats.empty();
  const TypeDesc type = eight_bit ? TypeDesc::UINT8 : TypeDesc::FLOAT;
  ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height),
                 static_cast<int>(image.channels), type);
  spec.attribute("oiio:ColorSpace", eight_bit ? "sRGB" : "Linear");
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("CompressionQuality", 95);
  for (const Attribute& attribute : attributes) std::visit(AddTo{spec, attribute.name}, attribute.value);
  const void* const pixels = eight_bit ? static_cast<const void*>(image.bytes.data()) : image.floats.data();
  return output.open(file, spec) && output.write_image(type, pixels) && output.close();
}

}  // namespace

std::optional<PixelLayout> OpenImageIoLibrary::layout(const std::string& path) const {
  const ImageOutput::unique_ptr output = find_writer(path);
  if (!output) return std::nullopt;
  if (std::strcmp(output->format_name(), "hdr") == 0) return PixelLayout::float_rgb;
  return output->supports("alpha") ? PixelLayout::srgb8_alpha : PixelLayout::srgb8;
}

void OpenImageIoLibrary::write(const std::string& path, const std::string& temporary, const FlatImage& image,
                               const std::vector<Attribute>& attributes) const {
  const ImageOutput::unique_ptr writer = find_writer(path);
  if (!writer) throw Error(Location{path}, "unknown image format");
  bool written = false;
  std::string why;
  try {
    written = write_pixels(*writer, temporary, image, attributes);
    if (!written) why = writer->geterror();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    why = error.what();
  }
  if (!written) fail(path, "cannot write: " + first_line(why, "unknown reason"));
}

}  // namespace oktett::oiio
