#pragma once
/// \file The transform of an object in a scene file. Within io/ only.

#include "core/transform.h"
#include "io/scene/values.h"

namespace oktett {

/// A list of operations, applied in order, or a single one: translate, scale, rotate or matrix. The result
/// may be singular.
Affine read_transform(SceneValues& values, const YamlNode& node);

}  // namespace oktett
