#pragma once
/// \file Exact surfaces in scene files. Within io/ only.

#include <optional>
#include <string>
#include <vector>

#include "io/scene_load.h"
#include "kernels/shapes/exact_data.h"

namespace oktett {

/// Keys of the exact surfaces.
std::vector<std::string> exact_keys();

/// The exact surface called `key`; nothing if it is degenerate, after a warning, or if there is no such key
/// (`known` says which). Throws Error at the place of what is wrong.
std::optional<ExactShape> read_exact(SceneLoad& load, const YamlNode& key, const YamlNode& node, bool& known);

}  // namespace oktett
