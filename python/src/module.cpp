#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <tbb/global_control.h>

#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/isa.h"
#include "python/src/bind.h"

namespace oktett::python {
namespace {

namespace py = pybind11;

void translate(std::exception_ptr error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const Error& e) {
    PyErr_SetString(e.kind() == ErrorKind::io ? PyExc_OSError : PyExc_ValueError, e.what());
  }
}

/// Null: as many threads as the process may use.
std::optional<tbb::global_control>& thread_limit() {
  static std::optional<tbb::global_control> limit;
  return limit;
}

void set_threads(std::size_t count) {
  thread_limit().reset();
  if (count > 0) thread_limit().emplace(tbb::global_control::max_allowed_parallelism, count);
}

}  // namespace

PYBIND11_MODULE(_oktett, module) {
  module.doc() = "The compiled part of oktett.";
  py::register_exception_translator(translate);
  module.attr("__version__") = OKTETT_VERSION;
  module.def("set_threads", set_threads, py::arg("count"),
             "Limits queries, building and rendering to `count` threads; 0: as many as the process may use.");
  module.def(
      "isa", [] { return std::string(to_string(default_isa())); },
      "The instruction set that is used: \"avx512\", \"avx2\", \"sse4.2\" or \"scalar\".\n\n"
      "It is the widest that the processor has, or what the environment variable OKTETT_ISA names.\n"
      "Answers are the same bits with each.");
  SceneClass scene(module, "Scene", "Things to trace and to render. See the documentation of the package.");
  bind_scene(scene);
  bind_render(scene);
  bind_ray_queries(scene);
  bind_point_queries(scene);
}

}  // namespace oktett::python
