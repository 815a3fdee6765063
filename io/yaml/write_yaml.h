#pragma once
/// \file Trees as YAML. Within io/ only.

#include <string>

#include "io/yaml/yaml.h"

namespace oktett {

/// A node in one line, as it stands in a flow map or list.
std::string flow_text(const YamlNode& node);

/// A whole document. Maps and lists that fit into a line stand in one.
std::string yaml_text(const YamlNode& root);

}  // namespace oktett
