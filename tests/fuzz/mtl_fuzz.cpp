// Materials in MTL files.

#include <vector>

#include "io/obj/obj.h"
#include "tests/fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  return test::fuzz_reader("a.mtl", data, size, [](const std::string& path) {
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<Warning> warnings;
    load_mtl(path, materials, textures, warnings);
  });
}
