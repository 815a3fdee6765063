#pragma once
/// \file The ends of the names of files.

#include <string>

namespace oktett {

/// ".obj" of "a.OBJ".
std::string lower_case_extension(const std::string& path);

/// Whether the name ends in `.gz`, in upper or lower case: gzip has packed the file.
bool is_packed(const std::string& path);
/// The path without that end.
std::string without_packing(const std::string& path);

}  // namespace oktett
