#pragma once
/// \file The textures of a scene, read from image files.

#include <memory>
#include <span>
#include <vector>

#include "core/error.h"
#include "render/material.h"
#include "render/texture_sampler.h"

namespace oktett {

/// Textures from image files: bilinear within a MIP level, trilinear and anisotropic across levels when the
/// footprint is known.
///
/// Colours are made linear before they are filtered: 8-bit images count as sRGB unless the file says
/// otherwise. `value` gives the texture's channel as stored, `normal` the first three. Unassociated alpha is
/// ignored. uv is multiplied by `scale`, turned by `rotation`, moved by `offset`, then wrapped; (0, 0) is the
/// lower left corner of the image. The result is base + gain * texel.
///
/// A lookup depends on its arguments alone: each MIP level is computed from the one above by a fixed rule.
class ImageTextures : public TextureSampler {
 public:
  /// Reads all images, in parallel. One that is missing or damaged gives a warning and is white (value 1)
  /// everywhere. So is a texture without a path, without a warning: its reader has given one.
  explicit ImageTextures(std::vector<Texture> textures);
  /// The same; warnings have the place in `places` of the first texture of that file, and name the file, if
  /// there is such a place.
  ImageTextures(std::vector<Texture> textures, std::span<const Location> places);

  /// One per file that could not be used.
  const std::vector<Warning>& warnings() const { return warnings_; }

  /// An index beyond the textures gives white. Non-finite uv count as 0.
  Color color(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const override;
  float value(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const override;
  /// Gain and base are not applied. A texture that could not be used gives (0.5, 0.5, 1).
  Vec3f normal(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const override;

 private:
  std::unique_ptr<TextureSampler> sampler_;  ///< null without textures
  std::vector<Warning> warnings_;
};

}  // namespace oktett
