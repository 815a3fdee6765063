// Meshes of raw floats: hits through the tree against those of each triangle alone.

#include <memory>
#include <vector>

#include "tests/fuzz/tracing.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  test::InputBytes bytes(data, size);
  const auto shape = bytes.take<std::uint8_t>();
  TriangleMesh mesh;
  const std::size_t vertices = 3 + shape % 29, triangles = 1 + bytes.take<std::uint8_t>() % 40;
  for (std::size_t i = 0; i < vertices; ++i) {
    Vec3f p;
    for (int k = 0; k < 3; ++k) p[k] = bytes.number();
    mesh.positions.push_back(p);
  }
  for (std::size_t i = 0; i < 3 * triangles; ++i)
    mesh.indices.push_back(static_cast<std::uint32_t>(bytes.take<std::uint8_t>() % vertices));
  BuildOptions options;
  options.quality = static_cast<BuildQuality>(shape >> 5 & 1 ? 2 : shape >> 6 & 1);
  options.parallel = false;
  const std::vector<Ray> rays = test::take_rays(bytes, 16);
  const auto accel = build_accel({{MeshGeometry{&mesh}, {}, 0}}, options);
  const std::vector<Hit> hits = test::trace_every_way(*accel, rays);

  std::vector<Hit> nearest(rays.size()), one(rays.size());
  for (std::size_t i = 0; i < triangles; ++i) {
    TriangleMesh single;
    single.positions = mesh.positions;
    for (std::size_t k = 0; k < 3; ++k) single.indices.push_back(mesh.indices[3 * i + k]);
    const auto alone = build_accel({{MeshGeometry{&single}, {}, 0}}, {BuildQuality::fast, false});
    closest_hit(*alone, rays, one, Isa::scalar);
    for (std::size_t r = 0; r < rays.size(); ++r)
      if (one[r].valid() && one[r].t < nearest[r].t) nearest[r] = one[r], nearest[r].item = 0;
  }
  for (std::size_t r = 0; r < rays.size(); ++r) {
    test::require(hits[r].valid() == nearest[r].valid(), "the tree misses no triangle and invents none");
    if (hits[r].valid()) test::require(hits[r].t == nearest[r].t, "the tree finds the nearest triangle");
  }
  return 0;
}
