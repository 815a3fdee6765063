#pragma once
/// \file The shapes of a scene file, one reader per shape key. Within io/ only.

#include <optional>
#include <string>
#include <vector>

#include "io/scene/load.h"

namespace oktett {

/// Every shape key but `group` and `instance`, which are no shapes of their own.
const std::vector<std::string>& shape_keys();

/// The shape that `node`, the value of `key`, describes. Nothing, after a warning, if it is degenerate.
std::optional<Shape> read_shape(SceneLoad& load, const YamlNode& key, const YamlNode& node);

}  // namespace oktett
