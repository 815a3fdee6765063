#pragma once
/// \file Results of lobes, and limits of their parameters.

#include <algorithm>

#include "core/vec3.h"

namespace oktett {

/// Scattering from one direction.
struct BsdfValue {
  Color value;    ///< f |cos(wi)|, the sum of all lobes that are not delta
  float pdf = 0;  ///< density per solid angle of `sample` choosing wi by those lobes
};

/// A sampled direction.
struct BsdfSample {
  Vec3f direction;
  Color weight;              ///< value / pdf; for delta lobes their coefficient / probability
  float pdf = 0;             ///< as in BsdfValue; 0 for delta lobes
  bool delta = false;        ///< the direction is one of finitely many
  bool transmitted = false;  ///< the direction leads below the surface
};

/// `x` within [least, most]; `least` for NaN.
inline double limited(double x, double least, double most) { return x > least ? std::min(x, most) : least; }
inline Vec3d limited(const Color& c, double least, double most) {
  return {limited(c.x, least, most), limited(c.y, least, most), limited(c.z, least, most)};
}

}  // namespace oktett
