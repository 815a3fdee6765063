#include <gtest/gtest.h>

#ifdef OKTETT_HAVE_TINYOBJLOADER
#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "io/obj/obj.h"
#include "tests/io/obj_test_support.h"

namespace oktett::test::obj_peer_test {
namespace {

/// Polygons in the order of the file.
tinyobj::ObjReader load_with_peer(const std::string& path) {
  tinyobj::ObjReaderConfig config;
  config.triangulate = false;
  tinyobj::ObjReader reader;
  EXPECT_TRUE(reader.ParseFromFile(path, config)) << path << ": " << reader.Error();
  return reader;
}

Vec3d area_of(const TriangleMesh& mesh, const std::vector<std::uint32_t>& corners) {
  Vec3d sum;
  const Vec3d origin(mesh.positions[corners[0]]);
  for (std::size_t i = 2; i < corners.size(); ++i)
    sum += cross(Vec3d(mesh.positions[corners[i - 1]]) - origin, Vec3d(mesh.positions[corners[i]]) - origin);
  return sum;
}

std::uint32_t id(int index) { return index < 0 ? kNoId : static_cast<std::uint32_t>(index); }

/// Compares the vertex data bit by bit: both round to the nearest float up to the peer's own error.
void expect_same_numbers(const std::vector<float>& theirs, const void* data, std::size_t count) {
  const auto* ours = static_cast<const float*>(data);
  ASSERT_EQ(theirs.size(), count);
  for (std::size_t i = 0; i < count; ++i)
    ASSERT_NEAR(theirs[i], ours[i], 1e-6 * std::abs(theirs[i]) + 1e-30) << "number " << i;
}

/// The triangles of one polygon, from `triangle` on: the same corners, the same area vector.
void expect_same_polygon(const TriangleMesh& mesh, std::size_t triangle, const tinyobj::index_t* corners,
                         std::size_t count) {
  std::vector<std::uint32_t> polygon;
  for (std::size_t k = 0; k < count; ++k) polygon.push_back(id(corners[k].vertex_index));
  Vec3d area;
  for (std::size_t i = 3 * triangle; i < 3 * (triangle + count - 2); i += 3)
    area += area_of(mesh, {mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]});
  const Vec3d expected = area_of(mesh, polygon);
  ASSERT_LE(length(area - expected), 1e-6 * length(expected) + 1e-20) << "triangle " << triangle;
  for (std::size_t i = 3 * triangle; i < 3 * (triangle + count - 2); ++i) {
    const auto matches = [&](const tinyobj::index_t& c) {
      return id(c.vertex_index) == mesh.indices[i] &&
             (mesh.uv_indices.empty() ? kNoId : mesh.uv_indices[i]) == id(c.texcoord_index) &&
             (mesh.normal_indices.empty() ? kNoId : mesh.normal_indices[i]) == id(c.normal_index);
    };
    ASSERT_TRUE(std::any_of(corners, corners + count, matches)) << "corner " << i;
    ASSERT_TRUE(count > 3 || matches(corners[i - 3 * triangle])) << "corner " << i;
  }
}

void expect_same_as_peer(const std::string& path) {
  SCOPED_TRACE(path);
  const tinyobj::ObjReader peer = load_with_peer(path);
  const ObjFile file = load_obj(path);
  const TriangleMesh& mesh = file.mesh;
  const tinyobj::attrib_t& attributes = peer.GetAttrib();
  expect_same_numbers(attributes.vertices, mesh.positions.data(), 3 * mesh.positions.size());
  expect_same_numbers(attributes.normals, mesh.normals.data(), 3 * mesh.normals.size());
  expect_same_numbers(attributes.texcoords, mesh.uvs.data(), 2 * mesh.uvs.size());
  std::size_t triangle = 0;
  for (const tinyobj::shape_t& shape : peer.GetShapes()) {
    std::size_t corner = 0;
    for (const std::size_t count : shape.mesh.num_face_vertices) {
      ASSERT_LE(triangle + count - 2, mesh.triangle_count());
      expect_same_polygon(mesh, triangle, &shape.mesh.indices[corner], count);
      if (::testing::Test::HasFatalFailure()) return;
      corner += count;
      triangle += count - 2;
    }
  }
  EXPECT_EQ(triangle, mesh.triangle_count());
}

/// A grid of quads and triangles with uvs and normals, in all forms of corners.
std::string generate(std::uint32_t seed) {
  std::mt19937 random(seed);
  const int n = 4 + static_cast<int>(random() % 30);
  std::string text = "o grid\n";
  const auto add = [&text](const char* format, double a, double b, double c) {
    char buffer[128];
    std::snprintf(buffer, sizeof buffer, format, a, b, c);
    text += buffer;
  };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      add("v %.7g %.4f %g\n", x * 1.234567, y * 0.777, static_cast<double>(random() % 1000) / 7000);
      add("vt %.5f %.6f\n", x / (n - 1.0), y / (n - 1.0), 0);
      add("vn %.4f %.4f %.4f\n", 0.1 * x, 0.2, 1);
    }
  for (int y = 0; y + 1 < n; ++y)
    for (int x = 0; x + 1 < n; ++x) {
      const int first = y * n + x + 1, form = static_cast<int>(random() % 5);
      const int quad[4] = {first, first + 1, first + n + 1, first + n};
      text += "f";
      for (int k = 0; k < (random() % 2 ? 4 : 3); ++k) {
        const std::string i = std::to_string(form == 4 ? quad[k] - n * n - 1 : quad[k]);
        text += " " + i + (form == 1 ? "/" + i : form == 2 ? "//" + i : form == 3 ? "/" + i + "/" + i : "");
      }
      text += "\n";
    }
  return text;
}

TEST(ObjPeer, GeneratedMeshesEqualTinyobjloader) {
  const ObjFiles files;
  for (std::uint32_t seed = 0; seed < 40; ++seed)
    expect_same_as_peer(files.dir.write("grid.obj", generate(seed)));
}

TEST(ObjPeer, MeshesOnThisMachineEqualTinyobjloader) {
  namespace fs = std::filesystem;
  std::vector<std::string> paths;
  if (const char* directory = std::getenv("OKTETT_MESH_DIR"))
    for (const fs::directory_entry& entry : fs::directory_iterator(directory))
      if (entry.path().extension() == ".obj") paths.push_back(entry.path().string());
  const std::string bunny = "/usr/share/glmark2/models/bunny.obj";
  if (fs::exists(bunny)) paths.push_back(bunny);
  for (const std::string& path : paths) expect_same_as_peer(path);
}

}  // namespace
}  // namespace oktett::test::obj_peer_test
#endif
