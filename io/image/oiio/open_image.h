#pragma once
/// \file The shared library of images, see io/image/library.h, and what its parts share. Not for other
/// folders.

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/image/color.h"
#include "io/image/library.h"

namespace oktett::oiio {

/// The library, whose reading and writing functions are defined in files of their own.
class OpenImageIoLibrary final : public ImageLibrary {
 public:
  std::optional<PixelLayout> layout(const std::string& path) const override;
  std::optional<std::vector<unsigned char>> encode(const std::string& path, const FlatImage& image,
                                                   const std::vector<Attribute>& attributes) const override;
  void write(const std::string& path, const std::string& temporary, const FlatImage& image,
             const std::vector<Attribute>& attributes) const override;
  Picture read(const std::string& path) const override;
  EnvironmentImage read_environment(const std::string& path) const override;
  HeightImage read_heights(const std::string& path, std::uint32_t most_side,
                           std::size_t most_pixels) const override;
  TexelImage read_texels(const TextureSource& source) const override;
};

/// The first line of an error text, without a full stop at its end; `fallback` if there is none.
std::string first_line(const std::string& text, const std::string& fallback);

/// Throws Error of kind io, which names `path`.
[[noreturn]] void fail(const std::string& path, const std::string& message);

/// Throws Error of kind io if such an image would take more than a quarter of this machine's memory.
void check_size_in_memory(const std::string& path, int width, int height, int channels);

/// Takes the pending global error of OpenImageIO; it would be printed at exit otherwise.
std::string take_image_error(const std::string& fallback);

/// How the colour channels of a file with this header are encoded: as the file says, else sRGB for integers
/// and linear for everything else. Throws Error if it has impossible primaries.
ColorEncoding color_encoding(const OIIO::ImageSpec& spec);

/// Opens an image for reading with colours as they are stored, not multiplied by an unassociated alpha. The
/// file is not trusted: throws Error of kind io if it cannot be opened, is not a plain two-dimensional image,
/// or would take more than a quarter of this machine's memory once read.
///
/// With `memory`, its bytes are those of the file, and `path` only names it; they must be a PNG, JPEG or WebP
/// image. It must live as long as the result.
OIIO::ImageInput::unique_ptr open_image(const std::string& path,
                                        OIIO::Filesystem::IOMemReader* memory = nullptr);

/// Whether the last reading of pixels failed although it returned true: the reader of TIFF goes on behind
/// strips that the file lacks, and only leaves a message. Messages of other readers may be mere warnings.
bool has_silent_error(const OIIO::ImageInput& input);

/// Reads channels [begin, end) of all pixels like OIIO::ImageInput::read_image; false also if
/// has_silent_error.
bool read_pixels(OIIO::ImageInput& input, int begin, int end, OIIO::TypeDesc type, void* pixels);

/// Reads channels [begin, end) of all pixels, row by row from the top, converted to `type`. Throws Error of
/// kind io, which names `path`, if the file is damaged.
void read_channels(OIIO::ImageInput& input, const std::string& path, int begin, int end, OIIO::TypeDesc type,
                   void* pixels);

}  // namespace oktett::oiio
