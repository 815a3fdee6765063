#pragma once
/// \file The ends of the names of files.

#include <string>

namespace oktett {

/// ".obj" of "a.OBJ".
std::string lower_case_extension(const std::string& path);

}  // namespace oktett
