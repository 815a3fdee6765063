// Meshes in OBJ files. What follows the line "%%" is the file a.mtl beside the mesh.

#include "io/obj/obj.h"
#include "tests/fuzz/mesh_checks.h"

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
    test::require_sound(m);
    for (const std::uint16_t slot : m.material_slots)
      test::require(slot == 0 || slot < file.materials.size(), "materials exist");
  } catch (const Error& e) {
    test::require(*e.what() != 0 && !e.where().file.empty(), "an error names the file");
  }
  return 0;
}
