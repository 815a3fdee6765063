#pragma once
/// \file The texture statements of MTL files: `map_Kd -o 0.5 0 -clamp on brick.png` and the like.

#include <map>
#include <string>
#include <vector>

#include "io/obj/mtl_line.h"
#include "render/material.h"

namespace oktett {

/// Adds textures to a list, equal ones once.
class TextureList {
 public:
  explicit TextureList(std::vector<Texture>& textures);
  std::uint32_t add(const Texture& texture);

 private:
  std::vector<Texture>& textures_;
  std::multimap<std::string, std::uint32_t> by_path_;
};

/// What a texture statement says.
struct MtlTexture {
  Texture texture;
  float bump_scale = 1;  ///< `-bm`
};

/// Reads the options and the file name behind the keyword. The name may contain blanks; it is relative to
/// `directory`. Nothing, and a warning, if there is no name.
std::optional<MtlTexture> read_mtl_texture(MtlLine& line, const std::string& directory);

}  // namespace oktett
