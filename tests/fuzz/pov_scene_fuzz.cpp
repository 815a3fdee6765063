// Scenes in POV-Ray's language as trees of scene files: every scene that is read is translated or refused.

#include "io/pov/translate/translate.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/pov_options.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  return test::fuzz_reader("scene.pov", data, size, [](const std::string& path) {
    const pov::Document document = pov::read_pov(path, test::small_pov_options());
    test::require(pov::translate(document, {}).root != nullptr, "a scene has a tree");
  });
}
