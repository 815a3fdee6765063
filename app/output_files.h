#pragma once
/// \file The files that a render writes must not replace each other.

#include <string>
#include <vector>

namespace oktett {

/// A file of a run: the option that names it, or what it is, and its path; an empty path: there is none.
struct NamedFile {
  std::string name, path;
};

/// Throws Error if two of the files are the same: what is written last would replace the other.
void check_files_differ(const std::vector<NamedFile>& files);

}  // namespace oktett
