#pragma once
/// \file Boolean combinations in scene files. Within io/ only.

#include <string>
#include <vector>

#include "io/scene/load.h"

namespace oktett {

/// "union", "intersection", "difference".
bool is_csg_key(const std::string& key);
std::vector<std::string> csg_keys();

/// What `key` makes of its operands.
CsgShape make_csg(const std::string& key, std::vector<Object> operands);

/// Several objects as one operand: their union.
Object unite(std::vector<Object> members, const Location& where);

/// Throws Error at the object's place if it has no inside: if it is flat, open, or a mesh that is not closed.
void require_solid(const SceneLoad& load, const Object& object);

}  // namespace oktett
