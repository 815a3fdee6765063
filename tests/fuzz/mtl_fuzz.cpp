// Materials in MTL files.

#include <vector>

#include "io/obj/obj.h"
#include "tests/fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  static test::InputFile file("a.mtl");
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Warning> warnings;
  try {
    load_mtl(file.write({reinterpret_cast<const char*>(data), size}), materials, textures, warnings);
  } catch (const Error& e) {
    test::require(*e.what() != 0 && !e.where().file.empty(), "an error names the file");
  }
  return 0;
}
