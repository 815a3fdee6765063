#pragma once
/// \file Follows a hit through instances and combinations to the structure that holds its item, and brings
/// its surface interaction back to the world.

#include <cmath>

#include "accel/accel_data.h"

namespace oktett {

/// The structure that holds the item of a hit, and the way there.
struct HitPlace {
  const Accel* accel = nullptr;
  Affine to_world, inverse;  ///< of that structure's space; the identity unless `moved`
  bool moved = false;
  bool flipped = false;             ///< Boolean combinations turn the normal round
  const Accel* combined = nullptr;  ///< the solids of the outermost combination on the way, if there is one
  Affine to_combined;               ///< from the world to their space
  std::uint32_t user = kNoId;       ///< of the outermost instance that has one

  /// True if a surface found in the structure is not yet what the world sees.
  bool changes() const { return moved || combined != nullptr; }
};

/// Follows an instance path to the structure that holds the item.
HitPlace follow_path(const Accel& accel, std::uint32_t path);

/// The ray as the structure at `place` sees it.
Ray ray_inside(const HitPlace& place, const Ray& ray);

/// Brings a surface interaction found inside instances and combinations to the world.
void move_interaction(const HitPlace& place, const Ray& ray, float t, SurfaceInteraction& s);

/// The error of a position on a combination of which faces within `reach` along the ray count as one: rays
/// that leave must clear them all. Rounded up.
OKTETT_INLINE float widened_error(float error, float reach, float direction) {
  return (error + reach * std::abs(direction)) * (1 + 0x1p-22f);
}

/// What a hit met, by the names that SurfaceInteraction has for it.
struct HitNames {
  std::uint32_t geometry, primitive, user;
  std::uint32_t material_slot = 0;
  Kind kind;
};
HitNames identify_in(const HitPlace& place, const Hit& hit);

/// The surface interaction of a hit whose place is known. uv and tangent may be missing unless `uv`.
void interaction_at(const HitPlace& place, const HitNames& names, const Ray& ray, const Hit& hit, bool uv,
                    SurfaceInteraction& s);

}  // namespace oktett
