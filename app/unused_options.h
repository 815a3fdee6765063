#pragma once
/// \file Options that would have no effect beside the others are refused, or a warning says so.

#include <string>

#include "app/render_options.h"

namespace oktett {

/// Where a rendered picture goes.
struct PictureTarget {
  std::string picture;  ///< path of the picture; empty: none is written
  bool film = false;    ///< a film is written instead of a picture
};

/// Refuses options that the target has no place for, and warns of others.
void check_target_options(const RenderArguments& arguments, const PictureTarget& target);

/// Warns of options for pictures of 8 bits if `picture` is an EXR or HDR file.
void warn_of_unused_tone(const SettingWords& words, const std::string& picture);

/// Refuses caustics where the integrator has none, and numbers of samples that would silently be others;
/// `scene` has all that was asked for. What else has no effect is added to its warnings.
void check_light_options(const RenderArguments& arguments, Scene& scene);

}  // namespace oktett
