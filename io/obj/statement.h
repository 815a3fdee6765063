#pragma once
/// \file What the readers of vertices and of faces share.

#include <string>
#include <utility>

#include "io/obj/failure.h"

namespace oktett {

/// Leaves the reader of a chunk, which keeps the failure.
struct ObjStop {
  ObjFailure failure;
};

[[noreturn]] inline void stop_at(const char* where, std::string message) {
  throw ObjStop{{where, std::move(message)}};
}

/// The passes read the same bytes unless someone writes to the file at the same time.
[[noreturn]] inline void stop_changed(const char* where) {
  stop_at(where, "the file changed while it was read");
}

}  // namespace oktett
