#pragma once
/// \file What type each value of a glTF file must have. Within io/gltf/ only.

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace oktett {

/// Goes through all that glTF 2.0 and the extensions that are read define, by one table. Whole numbers that
/// are written as 1.0 become whole ones. Throws Error, which names the place as in `nodes[1].children`, if a
/// value has another type than glTF gives it, a list of numbers another size, or if something is missing.
/// What no table knows, such as `extras`, may be anything.
void check_gltf_types(const std::string& path, nlohmann::json& root);

}  // namespace oktett
