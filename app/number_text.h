#pragma once
/// \file Numbers as JSON and YAML write them.

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "core/vec3.h"

namespace oktett {

/// The fewest digits that give back the number; null if it is not finite.
template <class T>
std::string number_text(T value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

/// "[x, y, z]"
template <class T>
std::string list_text(const Vec3<T>& v) {
  return "[" + number_text(v.x) + ", " + number_text(v.y) + ", " + number_text(v.z) + "]";
}

}  // namespace oktett
