// Scene files, beside which lie the small meshes and pictures that the examples use.

#include <filesystem>

#include "io/scene/scene_file.h"
#include "tests/fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  static test::InputFile file("scene.yaml");
  static const bool prepared = [] {
    const std::filesystem::path assets = std::filesystem::path(OKTETT_SOURCE_DIR) / "scenes" / "assets";
    std::filesystem::copy(assets, file.dir().path() / "assets", std::filesystem::copy_options::recursive);
    return true;
  }();
  test::require(prepared, "the assets are copied");
  try {
    load_scene_file(file.write({reinterpret_cast<const char*>(data), size}),
                    {{"bunny", "assets/tetrahedron.obj"}});
  } catch (const Error& e) {
    test::require(*e.what() != 0 && !e.where().file.empty(), "an error names the file");
  }
  return 0;
}
