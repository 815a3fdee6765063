#include "app/view/http.h"

#include <dlfcn.h>

#include <filesystem>
#include <system_error>

#include "core/error.h"

namespace oktett {

#ifdef OKTETT_HTTP_LIBRARY
std::unique_ptr<HttpServer> load_http_server() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  std::string why = "it is in none of its places";
  for (const char* place : {"../lib", OKTETT_LIBRARIES_FROM_PROGRAMS}) {
    const fs::path file = (folder / place / OKTETT_HTTP_LIBRARY).lexically_normal();
    if (!fs::exists(file, error)) continue;
    if (void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) {
      const auto make = reinterpret_cast<MakeHttpServer>(dlsym(library, kHttpServerSymbol));
      if (make != nullptr) return std::unique_ptr<HttpServer>(make());
    }
    const char* text = dlerror();
    why = text != nullptr ? text : "unknown reason";
  }
  throw Error(std::string("cannot load " OKTETT_HTTP_LIBRARY ": ") + why, ErrorKind::io);
}
#else
std::unique_ptr<HttpServer> load_http_server() {
  throw Error("this build has no viewer: cpp-httplib (libcpp-httplib-dev) was missing when it was made");
}
#endif

}  // namespace oktett
