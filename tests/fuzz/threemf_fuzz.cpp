// Meshes in 3MF files. An input that does not begin like a ZIP archive is the text of the model in one, as
// random changes of an archive hardly ever get past its checksums.

#include "io/threemf/threemf.h"
#include "tests/fuzz/mesh_checks.h"
#include "tests/support/threemf_package.h"

static void check_threemf(const std::string& path) {
  using namespace oktett;
  FileScene scene = load_threemf_scene(path);
  for (const SharedMesh& shared : scene.meshes) {
    test::require_sound(*shared.mesh);
    for (const std::uint16_t slot : shared.mesh->material_slots)
      test::require(slot < shared.slots.size(), "slots have materials");
    for (const std::uint32_t material : shared.slots)
      test::require(material == kNoId || material < scene.materials.size(), "materials exist");
  }
  for (const PlacedMesh& placed : scene.placements)
    test::require(placed.mesh < scene.meshes.size() && placed.to_world.is_invertible(), "places are good");
  if (can_be_one_mesh(scene)) test::require_sound(one_mesh(path, std::move(scene)).mesh);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (text.starts_with("PK")) return test::fuzz_reader("a.3mf", data, size, check_threemf);
  static const test::TempDir dir;
  const std::string packed = dir.file("packed.3mf");
  const auto parts = test::with_image(test::threemf_parts(text), "an image");
  test::require(test::pack_parts(packed, parts, ZIP_CM_STORE), "the package can be written");
  const std::string bytes = test::file_content(packed);
  return test::fuzz_reader("a.3mf", reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(),
                           check_threemf);
}
