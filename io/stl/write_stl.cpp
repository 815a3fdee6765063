#include "io/stl/stl.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/error.h"
#include "core/rounding.h"
#include "io/mesh/vertices.h"

namespace oktett {
namespace {

struct Facet {
  Vec3f normal;
  std::array<Vec3f, 3> corners;
};
static_assert(sizeof(Facet) == 48);

Facet facet_of(const TriangleMesh& mesh, std::size_t triangle) {
  Facet facet;
  for (std::size_t k = 0; k < 3; ++k) facet.corners[k] = mesh.positions[mesh.indices[3 * triangle + k]];
  facet.normal = flat_normal(facet.corners[0], facet.corners[1], facet.corners[2]);
  return facet;
}

void write_text(MeshOutput& out, const TriangleMesh& mesh) {
  out.text("solid oktett\n");
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    const Facet facet = facet_of(mesh, i);
    out.text("facet normal ").vector(facet.normal).text("\nouter loop\n");
    for (const Vec3f& corner : facet.corners) out.text("vertex ").position(mesh, corner).text("\n");
    out.text("endloop\nendfacet\n");
  }
  out.text("endsolid oktett\n");
}

void write_bytes(MeshOutput& out, const std::string& path, const TriangleMesh& mesh) {
  if (mesh.triangle_count() > std::numeric_limits<std::uint32_t>::max())
    throw Error(Location{path}, "cannot write: STL counts triangles in 32 bits");
  std::string header = "Written by Oktett";  // not "solid", by which text is told
  header.resize(80, ' ');
  out.text(header).bytes(static_cast<std::uint32_t>(mesh.triangle_count()));
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    Facet facet = facet_of(mesh, i);
    for (Vec3f& corner : facet.corners) corner = Vec3f(mesh.origin + Vec3d(corner));
    out.bytes(facet).bytes(std::uint16_t{0});
  }
}

}  // namespace

MeshLosses write_stl(const std::string& path, const MeshFile& file, bool ascii) {
  MeshOutput out(path);
  if (ascii)
    write_text(out, file.mesh);
  else
    write_bytes(out, path, file.mesh);
  out.commit();
  MeshLosses losses;
  if (!ascii && std::ranges::any_of(file.mesh.positions, [&](const Vec3f& p) {
        const Vec3d there = file.mesh.origin + Vec3d(p);
        return !(rounded_to_floats(there) == there);
      }))
    losses.push_back(kLostDigits);
  if (!file.mesh.uv_indices.empty()) losses.push_back("lost: texture coordinates");
  if (!file.mesh.normal_indices.empty()) losses.push_back("lost: normals of vertices");
  note_lost_attributes(
      file.mesh, [](const MeshAttribute&) { return false; }, losses);
  if (file.mesh.positions.size() < file.mesh.indices.size())
    losses.push_back("lost: which triangles share vertices; read it with --weld to join them again");
  return losses;
}

}  // namespace oktett
