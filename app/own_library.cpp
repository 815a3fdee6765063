#include "app/own_library.h"

#include <dlfcn.h>

#include <filesystem>
#include <string>
#include <system_error>

#include "core/error.h"

namespace oktett {

void* load_own_library(const char* file, const char* symbol) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  std::string looked_in, why;
  for (const char* place : {"../lib", OKTETT_LIBRARIES_FROM_PROGRAMS}) {
    const fs::path path = (folder / place / file).lexically_normal();
    if (!fs::exists(path, error)) {
      looked_in += (looked_in.empty() ? "" : " nor in ") + path.parent_path().string();
      continue;
    }
    if (void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL))
      if (void* address = dlsym(library, symbol)) return address;
    const char* text = dlerror();
    why = text != nullptr ? text : "unknown reason";
  }
  if (why.empty()) why = "it is neither in " + looked_in;
  throw Error(std::string("cannot load ") + file + ": " + why, ErrorKind::io);
}

}  // namespace oktett
