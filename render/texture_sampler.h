#pragma once
/// \file What the renderer asks of textures.

#include <cstdint>

#include "core/vec3.h"

namespace oktett {

/// Looks up the textures of a scene. Many threads call it at the same time, and a lookup must depend on its
/// arguments alone; then so does the picture. ImageTextures does it for image files.
class TextureSampler {
 public:
  virtual ~TextureSampler() = default;
  /// Filtered linear Rec.709 colour of texture `index` (into Scene::textures) at `uv`; (0,0) is the lower
  /// left corner. `dx` and `dy` are the changes of uv from this pixel to its neighbours, zero when unknown.
  virtual Color color(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const = 0;
  /// The same for data that carries no colour space (opacity, height): the texture's channel as stored.
  virtual float value(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const = 0;
  /// The same for tangent-space normals: the first three channels as stored. (0.5, 0.5, 1), the answer of
  /// samplers without normal maps, leaves the normal as it is.
  virtual Vec3f normal(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const {
    static_cast<void>(index), static_cast<void>(uv), static_cast<void>(dx), static_cast<void>(dy);
    return {0.5f, 0.5f, 1};
  }
};

}  // namespace oktett
