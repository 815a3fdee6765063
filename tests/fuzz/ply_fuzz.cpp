// Meshes in PLY files, in one piece and in small chunks.

#include <algorithm>

#include "io/ply/ply.h"
#include "tests/fuzz/mesh_checks.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  return test::fuzz_reader("a.ply", data, size, [](const std::string& path) {
    const ParsedMesh mesh = parse_ply(path);
    test::require_sound(mesh.mesh);
    const ParsedMesh chunks = parse_ply(path, {.chunk_bytes = 16});
    test::require_sound(chunks.mesh);
    test::require(std::ranges::equal(mesh.mesh.indices, chunks.mesh.indices), "the same triangles in chunks");
  });
}
