/// \file Shared libraries that belong to this program and bring others along: loaded only when they are
/// needed.

#include <dlfcn.h>

#include <filesystem>
#include <string>
#include <system_error>

#include "app/terminal/encoder.h"
#include "app/view/http.h"
#include "core/error.h"

namespace oktett {

/// The address of `symbol` in the library `file`, which lies where the build or the installation puts it. It
/// stays loaded. Throws Error of kind io if it cannot be loaded.
static void* load_own_library(const char* file, const char* symbol) {
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

#ifdef OKTETT_TERMINAL_LIBRARY
const TerminalEncoder& terminal_encoder() {
  static const auto get =
      reinterpret_cast<GetTerminalEncoder>(load_own_library(OKTETT_TERMINAL_LIBRARY, kTerminalEncoderSymbol));
  return *get();
}
#else
const TerminalEncoder& terminal_encoder() {
  throw Error(
      "--show: this build shows no pictures on terminals: chafa (libchafa-dev) was missing when it was made");
}
#endif

#ifdef OKTETT_HTTP_LIBRARY
std::unique_ptr<HttpServer> load_http_server() {
  const auto make =
      reinterpret_cast<MakeHttpServer>(load_own_library(OKTETT_HTTP_LIBRARY, kHttpServerSymbol));
  return std::unique_ptr<HttpServer>(make());
}
#else
std::unique_ptr<HttpServer> load_http_server() {
  throw Error("this build has no viewer: cpp-httplib (libcpp-httplib-dev) was missing when it was made");
}
#endif

}  // namespace oktett
