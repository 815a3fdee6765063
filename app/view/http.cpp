#include "app/view/http.h"

#include "app/own_library.h"
#include "core/error.h"

namespace oktett {

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
