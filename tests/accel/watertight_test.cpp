#include <gtest/gtest.h>

#include "verify/checks/meshes.h"

namespace oktett::watertight_test {
namespace {

TEST(OracleMesh, GeneratedMeshesAreClosed) {
  for (const OracleMesh& m : make_closed_meshes()) {
    EXPECT_EQ(open_edge_count(m.mesh), 0u) << m.name;
    const Vec3d inside = m.name == "torus" ? Vec3d{1, 0.01, 0.02} : Vec3d{0.01, 0.0, 0.0};
    EXPECT_NEAR(winding_number(m.mesh, inside), 1, 1e-9) << m.name;
    EXPECT_NEAR(winding_number(m.mesh, {3, 4, 5}), 0, 1e-9) << m.name;
  }
}

// Closed meshes have no leaks, are crossed an odd number of times from inside and an even number from
// outside, also through vertices and edges, and every way of tracing gives the same bits, at every scale.
TEST(Watertight, ClosedMeshesAreCrossedConsistently) {
  for (const OracleMesh& m : make_closed_meshes())
    for (const MeshPlacement& p : mesh_placements()) {
      const MeshTally t = verify_mesh(m, p, 2048, available_isas());
      EXPECT_EQ(t.failures(), 0u) << m.name << ' ' << p.name << ": " << t.failure;
      EXPECT_GT(t.hits, t.rays / 3) << m.name << ' ' << p.name;
    }
}

// The same through trees of other splits, and through triangles in pieces.
TEST(Watertight, OtherTreesChangeNothing) {
  for (const OracleMesh& m : make_closed_meshes())
    for (const MeshPlacement& p : mesh_placements())
      for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::best, BuildQuality::compact}) {
        const MeshTally t = verify_mesh(m, p, 512, available_isas(), {quality});
        EXPECT_EQ(t.failures(), 0u) << m.name << ' ' << p.name << ": " << t.failure;
      }
}

TEST(Watertight, OpenMeshesAreTracedTheSameEverywhere) {
  OracleMesh m = make_torus(16, 8);
  m.mesh.indices.resize_uninitialized(m.mesh.indices.size() - 30);
  const MeshTally t = verify_mesh(m, mesh_placements()[0], 2048, available_isas());
  EXPECT_GT(t.open_edges, 0u);
  EXPECT_EQ(t.failures(), 0u) << t.failure;
}

}  // namespace
}  // namespace oktett::watertight_test
