// Scenes in POV-Ray's language as trees of scene files: every scene that is read is translated or refused.

#include "io/pov/read_pov.h"
#include "io/pov/translate/translate.h"
#include "tests/fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  return test::fuzz_reader("scene.pov", data, size, [](const std::string& path) {
    pov::ReadOptions options;
    options.library_folders.clear();
    options.limits.steps = 20'000;
    options.limits.values = 100'000;
    options.limits.array_elements = 10'000;
    options.limits.string_length = 10'000;
    options.limits.macro_depth = 200;
    options.limits.nesting = 100;
    const pov::Document document = pov::read_pov(path, options);
    test::require(pov::translate(document, {}).root != nullptr, "a scene has a tree");
  });
}
