// Scenes in glTF files, as objects and as one mesh.

#include "io/gltf/gltf.h"
#include "tests/fuzz/mesh_checks.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  return test::fuzz_reader("a.glb", data, size, [](const std::string& path) {
    GltfScene scene = load_gltf_scene(path);
    for (const GltfSharedMesh& shared : scene.meshes) {
      test::require_sound(*shared.mesh);
      for (const std::uint16_t slot : shared.mesh->material_slots)
        test::require(slot < shared.slots.size(), "slots have materials");
      for (const std::uint32_t material : shared.slots)
        test::require(material == kNoId || material < scene.materials.size(), "materials exist");
    }
    for (const GltfPlacement& placement : scene.placements)
      test::require(placement.mesh < scene.meshes.size() && placement.to_world.is_invertible(),
                    "places are good");
    if (!can_be_one_mesh(scene)) return;
    const MeshFile file = one_mesh(path, std::move(scene));
    test::require_sound(file.mesh);
    for (const std::uint16_t slot : file.mesh.material_slots)
      test::require(slot < file.materials.size(), "slots have materials");
  });
}
