#pragma once
/// \file Files that may have been meant instead of one that does not exist.

#include <string>

namespace oktett {

/// "; did you mean 'x'?" with the file in the folder of `path` whose name is most like that of `path`, which
/// does not exist; nothing if none is. Upper and lower case count as the same, and about one letter in three
/// may differ. Looks at no more than 10,000 names, and names no file that may not be read.
std::string did_you_mean_file(const std::string& path);

}  // namespace oktett
