#pragma once
/// \file How many objects the components of a 3MF file show, before lib3mf reads it.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace oktett {

/// Throws Error, which names `path`, if some object of the models shows more than a million objects, with
/// components of components, or nests them deeper than 64 levels. `parts` are the files of the package by
/// name, any of which may be a model. lib3mf visits each object as often as it is shown.
void check_components(const std::string& path, const std::vector<std::pair<std::string, std::string>>& parts);

}  // namespace oktett
