#pragma once
/// \file Shared libraries that belong to Oktett and bring others along: loaded only when they are needed.
/// For io/ only.

#include <cstddef>

namespace oktett {

struct LoadedLibrary {
  const char* file;     ///< name of the file, such as "liboktett_images.so.0.1.0"
  const char* entry;    ///< the function that it shows
  const char* purpose;  ///< for messages: "reads and writes images"
  /// Where less address space than this is left, std::bad_alloc is thrown and nothing loaded: constructors of
  /// some libraries start threads, and wait for ever where the system refuses one.
  std::size_t needed_space = 0;
};

/// The address of the library's entry. It stays loaded as long as the process lives. Throws Error of kind io
/// if it cannot be loaded.
void* load_library(const LoadedLibrary& library);

/// True if the file is found, so that load_library can be relied on. Loads nothing. False may only mean that
/// the system's cache knows more.
bool is_installed(const LoadedLibrary& library);

}  // namespace oktett
