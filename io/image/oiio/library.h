#pragma once
/// \file The shared library of images, see io/image/library.h. Not for other folders.

#include "io/image/library.h"

namespace oktett::oiio {

/// Each member function is defined in the file named after it.
class OpenImageIoLibrary final : public ImageLibrary {
 public:
  std::optional<PictureLayout> layout(const std::string& path) const override;
  void write(const std::string& path, const std::string& temporary, const Picture& picture,
             const ImageMetadata& metadata) const override;
  Picture read(const std::string& path) const override;
  HeightImage read_heights(const std::string& path, std::uint32_t most_side,
                           std::size_t most_pixels) const override;
  std::unique_ptr<TextureSampler> load_textures(std::vector<Texture> textures,
                                                std::vector<Warning>& warnings) const override;
};

}  // namespace oktett::oiio
