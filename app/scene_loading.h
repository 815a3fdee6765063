#pragma once
/// \file The scene that the words of a command line ask for, and what its picture says of them.

#include <string>

#include "app/render_options.h"
#include "io/image/metadata.h"
#include "render/scene.h"

namespace oktett {

/// Reads the scene, gives a mesh alone its look, and overrides settings. Throws Error.
Scene load_as_asked(const RenderArguments& arguments);

/// What is known of the picture of `scene` before it is rendered; `command_line`: all words as they were
/// typed.
ImageMetadata first_metadata(const std::string& command_line, const RenderArguments& arguments,
                             const Scene& scene);

}  // namespace oktett
