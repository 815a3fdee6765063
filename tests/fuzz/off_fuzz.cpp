// Meshes in OFF files.

#include "io/off/off.h"
#include "tests/fuzz/mesh_checks.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  return test::fuzz_reader("a.off", data, size,
                           [](const std::string& path) { test::require_sound(parse_off(path).mesh); });
}
