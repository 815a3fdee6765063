#include "io/image/texture.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "io/image/image_access.h"
#include "io/image/library.h"
#include "io/text/files_read.h"
#include "io/text/stand_ins.h"

namespace oktett {

ImageTextures::ImageTextures(std::vector<Texture> textures) {
  std::set<std::string> refused;
  for (Texture& texture : textures) {
    if (texture.path.empty() || texture.content) continue;
    note_file_read(texture.path);
    const std::string why = why_not_an_image(texture.path);
    if (why.empty()) {
      texture.path = path_to_open(texture.path);
      continue;
    }
    if (refused.insert(texture.path).second)
      warnings_.push_back({Location{texture.path}, "texture not used: " + why + "; white instead"});
    texture.path.clear();
  }
  const auto is_image = [](const Texture& texture) { return !texture.path.empty(); };
  if (std::ranges::any_of(textures, is_image))
    sampler_ = image_library().load_textures(std::move(textures), warnings_);
}

ImageTextures::ImageTextures(std::vector<Texture> textures, std::span<const Location> places)
    : ImageTextures(textures) {
  for (Warning& warning : warnings_)
    for (std::size_t i = 0; i < std::min(textures.size(), places.size()); ++i) {
      if (path_to_open(textures[i].path) != path_to_open(warning.where.file) || places[i].line == 0) continue;
      warning.message = "texture " + textures[i].path + warning.message.substr(std::string("texture").size());
      warning.where = places[i];
      break;
    }
}

Color ImageTextures::color(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const {
  return sampler_ ? sampler_->color(index, uv, dx, dy) : Color{1, 1, 1};
}

float ImageTextures::value(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const {
  return sampler_ ? sampler_->value(index, uv, dx, dy) : 1;
}

Vec3f ImageTextures::normal(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const {
  return sampler_ ? sampler_->normal(index, uv, dx, dy) : Vec3f{0.5f, 0.5f, 1};
}

}  // namespace oktett
