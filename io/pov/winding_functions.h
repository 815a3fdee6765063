#pragma once
/// \file The functions of functions.inc that go around an axis or repeat over a plane. Within io/ only.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace oktett::pov {

/// As internal_text. Nothing for functions of other kinds.
std::optional<std::string> winding_text(std::uint32_t number, const std::vector<std::string>& operands);

}  // namespace oktett::pov
