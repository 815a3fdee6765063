// Meshes that Draco and meshoptimizer have packed.

#ifdef OKTETT_HAVE_DRACO
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#endif
#ifdef OKTETT_HAVE_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

#include <cmath>

#include "tests/io/gltf_test_support.h"

namespace oktett::test::gltf_packed_test {
namespace {

#ifdef OKTETT_HAVE_MESHOPTIMIZER

std::string packing(std::size_t offset, std::size_t length, std::size_t count, std::size_t stride,
                    const char* mode) {
  return ",\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,\"byteOffset\":" +
         std::to_string(offset) + ",\"byteLength\":" + std::to_string(length) +
         ",\"count\":" + std::to_string(count) + ",\"byteStride\":" + std::to_string(stride) +
         ",\"mode\":\"" + mode + "\"}}";
}

/// A grid packed by meshoptimizer; `break_it` changes the packed bytes of the vertices.
template <class Break>
std::string packed_grid(std::vector<Vec3f>& points, std::vector<std::uint32_t>& corners,
                        const Break& break_it) {
  constexpr std::uint32_t kSide = 30;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i)
    points.push_back({static_cast<float>(i % kSide), static_cast<float>(i / kSide),
                      std::sin(0.1f * static_cast<float>(i))});
  for (std::uint32_t y = 0; y + 1 < kSide; ++y)
    for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
      const std::uint32_t i = y * kSide + x;
      corners.insert(corners.end(), {i, i + 1, i + kSide, i + 1, i + kSide + 1, i + kSide});
    }
  std::string vertices(meshopt_encodeVertexBufferBound(points.size(), 12), '\0');
  vertices.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(vertices.data()),
                                             vertices.size(), points.data(), points.size(), 12));
  std::string triangles(meshopt_encodeIndexBufferBound(corners.size(), points.size()), '\0');
  triangles.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(triangles.data()),
                                             triangles.size(), corners.data(), corners.size()));
  break_it(vertices);
  GltfWriter out;
  out.binary = vertices;
  while (out.binary.size() % 4 != 0) out.binary += '\0';
  const std::size_t second = out.binary.size();
  out.binary += triangles;
  out.buffers = "{\"byteLength\":" + std::to_string(out.binary.size()) +
                "},{\"byteLength\":100000,\"extensions\":{\"EXT_meshopt_compression\":{\"fallback\":true}}}";
  out.views = "{\"buffer\":1,\"byteLength\":" + std::to_string(12 * points.size()) +
              packing(0, vertices.size(), points.size(), 12, "ATTRIBUTES") +
              "},{\"buffer\":1,\"byteLength\":" + std::to_string(4 * corners.size()) +
              packing(second, triangles.size(), corners.size(), 4, "TRIANGLES") + "}";
  out.accessor(0, kFloat, points.size(), "VEC3");
  out.accessor(1, kUint32, corners.size(), "SCALAR");
  return out.glb("\"extensionsRequired\":[\"EXT_meshopt_compression\"]," +
                 one_node("{\"attributes\":{\"POSITION\":0},\"indices\":1}"));
}

TEST(GltfPacked, Meshoptimizer) {
  const GltfFiles files;
  std::vector<Vec3f> points;
  std::vector<std::uint32_t> corners;
  const TriangleMesh mesh = files.load(packed_grid(points, corners, [](std::string&) {})).mesh;
  EXPECT_EQ(to_vector(mesh.positions), points);
  ASSERT_EQ(mesh.indices.size(), corners.size());
  // The codec turns triangles around, but keeps their order.
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    std::vector<std::uint32_t> a(corners.begin() + static_cast<std::ptrdiff_t>(i),
                                 corners.begin() + static_cast<std::ptrdiff_t>(i) + 3);
    const std::vector<std::uint32_t> b(mesh.indices.begin() + i, mesh.indices.begin() + i + 3);
    while (a[0] != b[0]) std::rotate(a.begin(), a.begin() + 1, a.end());
    EXPECT_EQ(a, b);
  }
}

TEST(GltfPacked, DamagedMeshoptimizerData) {
  const GltfFiles files;
  std::vector<Vec3f> points;
  std::vector<std::uint32_t> corners;
  const std::string bytes = packed_grid(points, corners, [](std::string& data) { data[0] = '\x33'; });
  EXPECT_EQ(files.error(bytes), "a.glb: accessors[0]: bufferViews[0]: its packed data are damaged");
  std::string json = bytes;
  const std::string count = "\"count\":900,\"byteStride\":12";
  json.replace(json.find(count), count.size(), "\"count\":900,\"byteStride\":13");
  EXPECT_EQ(files.error(json),
            "a.glb: accessors[0]: bufferViews[0]: its stride, count or filter do not go with its mode of "
            "compression");
  json = bytes;
  // As many digits, so that the chunk keeps its size.
  const std::string length = ",\"count\":900";
  json.replace(json.find(length), length.size(), ",\"count\":9e9");
  EXPECT_NE(files.error(json), "no error");
}

#endif

#ifdef OKTETT_HAVE_DRACO

/// A tetrahedron in Draco's form. In a skin the last point follows the second joint, the others the first;
/// without a skin joints and weights are left out.
std::string draco_bytes(const std::vector<Vec3f>& points, bool skin = false) {
  constexpr int kFaces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(4);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  using Four = std::array<std::uint8_t, 4>;
  const std::array<Four, 2> joints{{{0, 1, 0, 0}, {1, 0, 0, 0}}};
  const Four weights{200, 0, 0, 0};
  int joint = 0, weight = 0;
  if (skin) {
    joint = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_UINT8);
    weight = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_UINT8);
  }
  for (int i = 0; i < 4; ++i) {
    const draco::FaceIndex face(static_cast<std::uint32_t>(i));
    const auto set = [&](int attribute, const auto& value) {
      builder.SetAttributeValuesForFace(attribute, face, value(0), value(1), value(2));
    };
    set(position, [&](int k) { return &points[static_cast<std::size_t>(kFaces[i][k])]; });
    if (!skin) continue;
    set(joint, [&](int k) { return &joints[kFaces[i][k] == 3 ? 1 : 0]; });
    set(weight, [&](int) { return &weights; });
  }
  const auto mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

double volume_of(const TriangleMesh& mesh) {
  double volume = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    volume += dot(Vec3d(mesh.positions[mesh.indices[i]]), cross(Vec3d(mesh.positions[mesh.indices[i + 1]]),
                                                                Vec3d(mesh.positions[mesh.indices[i + 2]]))) /
              6;
  return volume;
}

std::string draco_file(const std::string& data, int attribute) {
  GltfWriter out;
  out.view(data);
  // As exporters write them: without views.
  out.accessors =
      "{\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},{\"componentType\":5125,\"count\":12,\"type\":"
      "\"SCALAR\"}";
  return out.glb(
      "\"extensionsUsed\":[\"KHR_draco_mesh_compression\"],\"extensionsRequired\":[\"KHR_draco_mesh_"
      "compression\"]," +
      one_node(
          "{\"attributes\":{\"POSITION\":0},\"indices\":1,\"extensions\":{\"KHR_draco_mesh_compression\":"
          "{\"bufferView\":0,\"attributes\":{\"POSITION\":" +
          std::to_string(attribute) + "}}}}"));
}

TEST(GltfPacked, Draco) {
  const GltfFiles files;
  const std::vector<Vec3f> points = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  const std::string data = draco_bytes(points);
  const TriangleMesh mesh = files.load(draco_file(data, 0)).mesh;
  ASSERT_EQ(mesh.positions.size(), 4u);
  ASSERT_EQ(mesh.triangle_count(), 4u);
  // Vertices come in an order of their own: the volume tells that all are there, and turned the right way.
  EXPECT_NEAR(volume_of(mesh), -1, 1e-6);
  EXPECT_EQ(files.error(draco_file(data, 5)),
            "a.glb: meshes[0].primitives[0]: its data hold no attribute 5 of 3 numbers");
  for (std::size_t size = 0; size < data.size(); ++size)
    EXPECT_NE(files.error(draco_file(data.substr(0, size), 0)), "no error") << size;
}

/// The tetrahedron with a skin or a morph target.
std::string bent_draco_file(GltfWriter& out, const std::string& data, const std::string& primitive,
                            const std::string& packed, const std::string& more, const std::string& node) {
  return out.glb("\"extensionsUsed\":[\"KHR_draco_mesh_compression\"],\"meshes\":[{" + more +
                 "\"primitives\":[{\"attributes\":{\"POSITION\":0" + primitive +
                 ",\"indices\":1,\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":" +
                 std::to_string(out.view(data)) + ",\"attributes\":{\"POSITION\":0" + packed +
                 "}}}}]}],\"skins\":[{\"joints\":[1,2]}],\"nodes\":[{\"mesh\":0" + node +
                 "},{},{\"translation\":[0,0,10]}],\"scenes\":[{\"nodes\":[0,1,2]}]");
}

constexpr const char* kTetrahedron =
    "{\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},{\"componentType\":5125,\"count\":12,\"type\":"
    "\"SCALAR\"}";

TEST(GltfPacked, DracoHasPartsOfWholeNumbersWhereAccessorsSaySo) {
  using Three = std::array<std::int16_t, 3>;
  const std::array<Three, 3> points{{{0, 0, -32768}, {32767, 0, 0}, {0, 16384, 0}}};
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(1);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_INT16);
  builder.SetAttributeValuesForFace(position, draco::FaceIndex(0), &points[0], &points[1], &points[2]);
  draco::Encoder encoder;
  draco::EncoderBuffer buffer;
  const auto mesh = builder.Finalize();
  ASSERT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  const GltfFiles files;
  const auto greatest = [&](const std::string& more) {
    GltfWriter out;
    out.accessors = "{\"componentType\":5122,\"count\":3,\"type\":\"VEC3\"" + more +
                    "},{\"componentType\":5125,\"count\":3,\"type\":\"SCALAR\"}";
    Vec3f most{0, 0, 0};
    const std::string file = bent_draco_file(out, {buffer.data(), buffer.size()}, "}", "", "", "");
    for (const Vec3f& p : files.load(file).mesh.positions)
      most = {std::max(most.x, p.x), std::max(most.y, p.y), std::max(most.z, -p.z)};
    return most;
  };
  EXPECT_EQ(greatest(""), (Vec3f{32767, 16384, 32768}));
  EXPECT_EQ(greatest(",\"normalized\":true"), (Vec3f{1, 16384.0f / 32767, 1}));
}

TEST(GltfPacked, DracoIsBentBySkins) {
  const GltfFiles files;
  const std::vector<Vec3f> points = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  GltfWriter out;
  const std::string four = ",{\"componentType\":5121,\"count\":4,\"type\":\"VEC4\"";
  out.accessors = kTetrahedron + four + "}" + four + ",\"normalized\":true}";
  const std::string skinned =
      bent_draco_file(out, draco_bytes(points, true), ",\"JOINTS_0\":2,\"WEIGHTS_0\":3}",
                      ",\"JOINTS_0\":1,\"WEIGHTS_0\":2", "", ",\"skin\":0");
  EXPECT_TRUE(files.load(skinned).warnings.empty());
  // The tip is at a height of 13.
  EXPECT_NEAR(volume_of(files.load(skinned).mesh), -13.0 / 3, 1e-4);
}

TEST(GltfPacked, DracoIsBentByMorphTargetsOfItsVertices) {
  const GltfFiles files;
  const std::vector<Vec3f> points = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  const std::string data = draco_bytes(points);
  std::vector<Vec3f> moves;
  for (const Vec3f& p : files.load(draco_file(data, 0)).mesh.positions) moves.push_back(p * 2.0f);
  const auto load = [&] {
    GltfWriter out;
    out.vectors({{0, 0, 0}}), out.vectors({{0, 0, 0}});
    const std::size_t target = out.vectors(moves);
    out.accessors = kTetrahedron + out.accessors.substr(out.accessors.rfind(",{"));
    return files.load(bent_draco_file(out, data,
                                      "},\"targets\":[{\"POSITION\":" + std::to_string(target) + "}]", "",
                                      "\"weights\":[1],", ""));
  };
  EXPECT_TRUE(load().warnings.empty());
  // All three sides are three times as long.
  EXPECT_NEAR(volume_of(load().mesh), -27, 1e-4);
  moves.push_back({});
  EXPECT_EQ(load().warnings.size(), 1u);
  EXPECT_NEAR(volume_of(load().mesh), -1, 1e-6);
}

#endif

}  // namespace
}  // namespace oktett::test::gltf_packed_test
