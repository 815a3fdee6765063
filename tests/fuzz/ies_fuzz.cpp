// Light profiles of the IES in files.

#include "io/photometry/ies_file.h"
#include "tests/fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  return test::fuzz_reader("a.ies", data, size,
                           [](const std::string& path) { (void)read_light_profile(path); });
}
