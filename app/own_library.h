#pragma once
/// \file Shared libraries that belong to this program and bring others along: loaded only when they are
/// needed.

namespace oktett {

/// The address of `symbol` in the library `file`, which lies where the build or the installation puts it. It
/// stays loaded. Throws Error of kind io if it cannot be loaded.
void* load_own_library(const char* file, const char* symbol);

}  // namespace oktett
