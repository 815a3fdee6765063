#include "io/oiio/library.h"

#include <utility>

namespace oktett::oiio {

namespace {

class OpenImageIoLibrary final : public ImageLibrary {
 public:
  std::optional<PictureLayout> layout(const std::string& path) const override { return find_layout(path); }
  void write(const std::string& path, const std::string& temporary, const Picture& picture,
             const ImageMetadata& metadata) const override {
    write_picture(path, temporary, picture, metadata);
  }
  Picture read(const std::string& path) const override { return read_picture(path); }
  HeightImage read_heights(const std::string& path, std::uint32_t most_side,
                           std::size_t most_pixels) const override {
    return oiio::read_heights(path, most_side, most_pixels);
  }
  std::unique_ptr<TextureSampler> load_textures(std::vector<Texture> textures,
                                                std::vector<Warning>& warnings) const override {
    return oiio::load_textures(std::move(textures), warnings);
  }
};

}  // namespace

}  // namespace oktett::oiio

/// The one symbol that the shared library shows; kImageLibraryEntry names it.
extern "C" __attribute__((visibility("default"))) const oktett::ImageLibrary* oktett_image_library();

const oktett::ImageLibrary* oktett_image_library() {
  static const oktett::oiio::OpenImageIoLibrary library;
  return &library;
}
