#pragma once
/// \file Photometric files of lamps: IESNA LM-63 of 1986, 1991, 1995 and 2002 (`.ies`).

#include <string>

#include "render/light/light_profile.h"

namespace oktett {

/// Reads the distribution of intensities of a file of photometric type C. Symmetric halves and quarters are
/// filled in. What the file says of sizes, lumens and tilt is skipped: the profile is relative to its
/// greatest value. Throws Error with file, line and column if the file cannot be read or is not of that
/// format.
LightProfile read_light_profile(const std::string& path);

}  // namespace oktett
