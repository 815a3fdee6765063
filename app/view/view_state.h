#pragma once
/// \file What a page may change about the picture: as text from the page, and back.

#include <string>
#include <string_view>

#include "render/picture/prepared_scene.h"

namespace oktett {

/// The view that a page asks for.
struct ViewState {
  Camera camera;
  Tone tone;
  std::string layer = "beauty";
};

/// Changes `state` by lines of the form key=value, e.g. "from=1 2 3". Keys: from, at, up, fov, height, focus,
/// tone, exposure, layer. Throws Error for anything else, for numbers that are not finite, and for cameras
/// that no scene file could have.
ViewState parse_view(std::string_view text, ViewState state);

/// The camera as the part of a scene file that gives the same camera, number by number. What moves it is left
/// out.
std::string camera_yaml(const Camera& camera);

}  // namespace oktett
