// Scene files, beside which lie the small meshes and pictures that the examples use.

#include <filesystem>

#include "io/scene/check.h"
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
  const Definitions definitions{{"bunny", "assets/tetrahedron.obj"}};
  const std::string path = file.write({reinterpret_cast<const char*>(data), size});
  std::string first;
  try {
    load_scene_file(path, definitions);
  } catch (const Error& e) {
    test::require(*e.what() != 0 && !e.where().file.empty(), "an error names the file");
    first = e.what();
  }
  // Checking finds the same error among others, and none where there is none.
  bool has_errors = false, has_first = false;
  for (const SceneFinding& finding : check_file(path, definitions).list) {
    has_errors |= finding.kind != SceneFinding::Kind::warning;
    has_first |= finding.text == first;
  }
  test::require(has_errors == !first.empty(), "checking agrees with loading");
  test::require(first.empty() || has_first, "checking tells the error that loading throws");
  return 0;
}
