#pragma once
/// \file The parts of the shared library of images, see io/image_library.h. Not for other folders.

#include "io/image_library.h"

namespace oktett::oiio {

std::optional<PictureLayout> find_layout(const std::string& path);
void write_picture(const std::string& path, const std::string& temporary, const Picture& picture,
                   const ImageMetadata& metadata);
Picture read_picture(const std::string& path);
HeightImage read_heights(const std::string& path, std::uint32_t most_side, std::size_t most_pixels);
std::unique_ptr<TextureSampler> load_textures(std::vector<Texture> textures, std::vector<Warning>& warnings);

}  // namespace oktett::oiio
