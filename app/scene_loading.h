#pragma once
/// \file The scene that the words of a command line ask for.

#include "app/render_options.h"
#include "render/scene.h"

namespace oktett {

/// Reads the scene, gives a mesh alone its look, and overrides settings. Throws Error.
Scene load_as_asked(const RenderArguments& arguments);

}  // namespace oktett
