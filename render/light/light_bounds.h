#pragma once
/// \file Bounds of where the light of one or several emitters comes from and where it goes (Conty and Kulla
/// 2018, "Importance sampling of many lights with adaptive tree splitting", section 4.1).

#include "core/box.h"
#include "core/vec3.h"

namespace oktett {

/// Each emitter lies in `box`. It has a normal within `spread` of the axis and gives light up to `reach` away
/// from its normal.
struct LightBounds {
  Box box;
  Vec3f axis{0, 0, 1};      ///< unit
  float spread = 0;         ///< radians, [0, pi]
  float reach = 0;          ///< radians, [0, pi / 2]
  bool both_sides = false;  ///< the same light goes to the side opposite to each normal
  /// Sum of radiance times area, in W / sr. Things that are not flat count as made of small pieces with
  /// normals in the cone, see lit_part.
  float power = 0;
};

/// About the mean cosine, none taken below 0, between the axis of a cone of normals and the normals.
double lit_part(double spread);

/// Bounds of the emitters of both.
LightBounds join(const LightBounds& a, const LightBounds& b);

}  // namespace oktett
