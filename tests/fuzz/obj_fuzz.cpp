// Meshes in OBJ files. What follows the line "%%" is the file a.mtl beside the mesh.

#include "io/obj/obj.h"
#include "tests/fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  static test::InputFile mesh("a.obj");
  static test::RewrittenFile library(mesh.dir().file("a.mtl"));
  std::string_view text(reinterpret_cast<const char*>(data), size);
  std::string_view materials;
  if (const std::size_t at = text.find("\n%%\n"); at != std::string_view::npos) {
    materials = text.substr(at + 4);
    text = text.substr(0, at + 1);
  }
  library.write(materials);
  try {
    const ObjFile file = load_obj(mesh.write(text));
    const TriangleMesh& m = file.mesh;
    test::require(m.indices.size() % 3 == 0, "three corners per triangle");
    for (const std::uint32_t i : m.indices) test::require(i < m.positions.size(), "corners exist");
    test::require(m.normal_indices.empty() || m.normal_indices.size() == m.indices.size(),
                  "normals per corner");
    for (const std::uint32_t i : m.normal_indices)
      test::require(i == kNoId || i < m.normals.size(), "normals exist");
    test::require(m.uv_indices.empty() || m.uv_indices.size() == m.indices.size(), "uv per corner");
    for (const std::uint32_t i : m.uv_indices) test::require(i == kNoId || i < m.uvs.size(), "uv exist");
    test::require(m.material_slots.empty() || m.material_slots.size() == m.triangle_count(), "slots");
    for (const std::uint16_t slot : m.material_slots)
      test::require(slot == 0 || slot < file.materials.size(), "materials exist");
    for (const Vec3f& p : m.positions)
      test::require(p.x - p.x == 0 && p.y - p.y == 0 && p.z - p.z == 0, "positions are finite");
  } catch (const Error& e) {
    test::require(*e.what() != 0 && !e.where().file.empty(), "an error names the file");
  }
  return 0;
}
