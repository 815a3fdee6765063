// Scenes in glTF files, as objects and as one mesh, at rest and moved.

#include "io/gltf/gltf.h"
#include "tests/fuzz/mesh_checks.h"

static void check_scene(const std::string& path, oktett::FileScene scene) {
  using namespace oktett;
  for (const SharedMesh& shared : scene.meshes) {
    test::require_sound(*shared.mesh);
    for (const std::uint16_t slot : shared.mesh->material_slots)
      test::require(slot < shared.slots.size(), "slots have materials");
    for (const std::uint32_t material : shared.slots)
      test::require(material == kNoId || material < scene.materials.size(), "materials exist");
  }
  for (const Material& material : scene.materials)
    test::require(material.interior == kNoId || material.interior < scene.media.size(), "media exist");
  for (const PlacedMesh& placement : scene.placements)
    test::require(placement.mesh < scene.meshes.size() && placement.to_world.is_invertible(),
                  "places are good");
  if (!can_be_one_mesh(scene)) return;
  const MeshFile file = one_mesh(path, std::move(scene));
  test::require_sound(file.mesh);
  for (const std::uint16_t slot : file.mesh.material_slots)
    test::require(slot < file.materials.size(), "slots have materials");
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  return test::fuzz_reader("a.glb", data, size, [](const std::string& path) {
    check_scene(path, load_gltf_scene(path));
    GltfOptions moved;
    moved.time = 0.4, moved.shutter = 0.1;
    check_scene(path, load_gltf_scene(path, moved));
  });
}
