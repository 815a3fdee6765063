// Density grids in files.

#include "io/volume/density_file.h"
#include "tests/fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  return test::fuzz_reader("a.density", data, size,
                           [](const std::string& path) { (void)read_density_file(path); });
}
