#pragma once
/// \file Which files may be read: regular ones, and, for scenes of strangers, those below one folder.

#include <string>

namespace oktett {

/// From here on, only files below the folder `root` may be read, wherever symbolic links lead. For the whole
/// process; call it before threads read. Throws Error if there is no such folder.
void confine_files(const std::string& root);

/// Whether confine_files has been called.
bool files_are_confined();

/// Why `path` cannot be read as a regular file, e.g. "no such file"; empty if it can. The files by which the
/// system shows its state (/proc, /sys and the like) do not count as regular: they may never end, and some
/// change the system when they are read.
std::string why_unreadable(const std::string& path);

/// The same for a file that has been opened: whatever its path leads to by now, this is what will be read.
std::string why_unreadable(int descriptor);

}  // namespace oktett
