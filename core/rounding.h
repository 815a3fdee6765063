#pragma once
/// \file Rounding that no compiler leaves out.

#include "core/vec3.h"

namespace oktett {

/// `v` rounded to floats. `Vec3d(Vec3f(v))` says the same, but where GCC 12 makes vectors of straight code it
/// takes the two conversions for none.
inline Vec3d rounded_to_floats(const Vec3d& v) {
  Vec3f f(v);
  asm("" : "+m"(f));  // says that f may have changed
  return Vec3d(f);
}

}  // namespace oktett
