#pragma once
/// \file The part of io/ that knows OpenImageIO, behind an interface; and which files may be read as images.
/// For io/ only.
///
/// OpenImageIO brings hundreds of shared libraries: to start with them takes a third of a second and 120 MB.
/// So its users, io/image/oiio/, are a shared library of their own, which is loaded when the first image is
/// read, or written in another format than those of io/image/encode.h. Most runs never need it.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/image/encode.h"
#include "io/image/heights.h"
#include "io/image/mip_map.h"
#include "render/picture.h"

namespace oktett {

/// An image file, as the textures that show it need it.
struct TextureSource {
  std::string path;
  std::shared_ptr<const std::string> content{};  ///< if not null, the bytes of the file
  TextureColors color_space = TextureColors::of_file;
  bool alpha = false;  ///< some texture shows the alpha channel
};

/// An image of all directions: the planes R, G and B, which fill the frame.
struct EnvironmentImage {
  Picture picture;
  bool is_cube =
      false;  ///< the six faces of a cube one above the other, as in EXR, else latitude and longitude
};

/// All members may be called by many threads at once; they throw Error of kind io for what files are not.
class ImageLibrary {
 public:
  /// Of files with `path`'s extension; nothing if no such file can be written. The formats of
  /// io/image/encode.h are not asked for.
  virtual std::optional<PixelLayout> layout(const std::string& path) const = 0;
  /// The bytes of a file with `path`'s extension that holds `image`. Nothing if OpenImageIO writes files of
  /// this format only by their names; then call `write`.
  virtual std::optional<std::vector<unsigned char>> encode(
      const std::string& path, const FlatImage& image, const std::vector<Attribute>& attributes) const = 0;
  /// Writes to the file `temporary`, which has `path`'s extension, and reads it back; errors are reported as
  /// those of `path`.
  virtual void write(const std::string& path, const std::string& temporary, const FlatImage& image,
                     const std::vector<Attribute>& attributes) const = 0;
  /// See read_image.
  virtual Picture read(const std::string& path) const = 0;
  /// See read_environment_image.
  virtual EnvironmentImage read_environment(const std::string& path) const = 0;
  /// See read_heights.
  virtual HeightImage read_heights(const std::string& path, std::uint32_t most_side,
                                   std::size_t most_pixels) const = 0;
  /// The image of a texture.
  virtual TexelImage read_texels(const TextureSource& source) const = 0;

 protected:
  ~ImageLibrary() = default;
};

/// Loads the library on the first call, for as long as the process lives. Throws Error of kind io if it
/// cannot be loaded.
const ImageLibrary& image_library();

/// True if the library's file is found, so that a later call of image_library can be relied on. Loads
/// nothing. False may only mean that the system's cache knows more.
bool image_library_is_installed();

/// What the shared library of io/image/oiio/ exports, by its name for dlsym.
inline constexpr const char* kImageLibraryEntry = "oktett_image_library";
using ImageLibraryEntry = const ImageLibrary* (*)();

/// Why `path` may not be read as an image; empty if it may be tried. While files are confined
/// (io/text/files.h), only files that begin like one of the usual formats are tried: others may name
/// further files, like the play lists of films.
std::string why_not_an_image(const std::string& path);

/// The path that is opened for the image `path`, which is noted as read. Throws Error of kind io if it may
/// not be read.
std::string image_to_open(const std::string& path);

}  // namespace oktett
