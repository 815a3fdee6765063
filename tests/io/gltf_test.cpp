#include <cmath>
#include <numbers>

#include "tests/io/gltf_test_support.h"

namespace oktett::test::gltf_test {
namespace {

/// A model of triangles, whose texture coordinates are exact when they are turned around.
MeshModel triangle_model(std::mt19937& random, bool normals, bool uvs) {
  MeshModel model = random_model(random, normals, uvs, false);
  for (MeshModel::Face& face : model.faces) face.corners.resize(3);
  for (Vec2f& uv : model.uvs) uv = {std::round(uv.x * 64) / 64, static_cast<float>(random() % 256) / 256};
  return model;
}

/// How a model becomes a file.
struct Style {
  int index = kUint32;
  bool interleaved = false;
  bool indexed = true;
};

std::string primitive_of(GltfWriter& out, const MeshModel& model, const Style& style) {
  std::vector<float> numbers[3];
  for (std::size_t i = 0; i < model.positions.size(); ++i) {
    const auto put = [&](std::size_t column, std::initializer_list<float> values) {
      std::vector<float>& list = numbers[style.interleaved ? 0 : column];
      list.insert(list.end(), values);
    };
    put(0, {model.positions[i].x, model.positions[i].y, model.positions[i].z});
    if (!model.normals.empty()) put(1, {model.normals[i].x, model.normals[i].y, model.normals[i].z});
    if (!model.uvs.empty()) put(2, {model.uvs[i].x, 1 - model.uvs[i].y});
  }
  std::string attributes;
  const bool has[3] = {true, !model.normals.empty(), !model.uvs.empty()};
  const char* const names[3] = {"POSITION", "NORMAL", "TEXCOORD_0"};
  std::size_t view = 0, offset = 0;
  std::string bytes;
  for (const float x : numbers[0]) append_bytes(bytes, x);
  if (style.interleaved) view = out.view(bytes, 12u + (has[1] ? 12u : 0u) + (has[2] ? 8u : 0u));
  for (std::size_t column = 0; column < 3; ++column) {
    if (!has[column]) continue;
    const char* const type = column == 2 ? "VEC2" : "VEC3";
    const std::size_t accessor = style.interleaved
                                     ? out.accessor(view, kFloat, model.positions.size(), type,
                                                    ",\"byteOffset\":" + std::to_string(offset))
                                     : out.array(numbers[column], kFloat, type, column == 2 ? 2 : 3);
    offset += column == 2 ? 8 : 12;
    attributes +=
        (attributes.empty() ? "\"" : ",\"") + std::string(names[column]) + "\":" + std::to_string(accessor);
  }
  std::vector<std::uint32_t> corners;
  for (const MeshModel::Face& face : model.faces)
    corners.insert(corners.end(), face.corners.begin(), face.corners.end());
  const auto narrow = [&]<class T>(T) { return std::vector<T>(corners.begin(), corners.end()); };
  const std::size_t indices = style.index == kUint8 ? out.array(narrow(std::uint8_t{}), kUint8, "SCALAR", 1)
                              : style.index == kUint16
                                  ? out.array(narrow(std::uint16_t{}), kUint16, "SCALAR", 1)
                                  : out.array(corners, kUint32, "SCALAR", 1);
  return "{\"attributes\":{" + attributes + "},\"indices\":" + std::to_string(indices) + "}";
}

// Every form has the columns of the OBJ file of the same mesh, bit for bit.
TEST(Gltf, AllFormsEqualTheObj) {
  const GltfFiles files;
  std::mt19937 random(1);
  for (int i = 0; i < 60; ++i) {
    MeshModel model = triangle_model(random, random() % 2, random() % 2);
    while (model.faces.empty()) model = triangle_model(random, random() % 2, random() % 2);
    const TriangleMesh mesh = files.files.load(obj_text(model)).mesh;
    Style style;
    style.index = std::vector{kUint8, kUint16, kUint32}[random() % 3];
    style.interleaved = random() % 2 == 0;
    GltfWriter out;
    const std::string rest = one_node(primitive_of(out, model, style));
    expect_same_mesh(files.load(out.glb(rest)).mesh, mesh);
    expect_same_mesh(files.load(out.text(rest), "b.gltf").mesh, mesh);
    files.files.write("out side.bin", out.binary);
    expect_same_mesh(files.load(out.json(rest, "out%20side.bin"), "c.gltf").mesh, mesh);
  }
}

TEST(Gltf, LargeMeshesGoToSeveralTasks) {
  const GltfFiles files;
  MeshModel model;
  for (int i = 0; i < 300000; ++i)
    model.positions.push_back({static_cast<float>(i), static_cast<float>(i % 7), 0});
  for (std::uint32_t i = 0; i + 3 < 300000; ++i) model.faces.push_back({{i, i + 1, i + 2}, {}});
  const TriangleMesh mesh = files.files.load(obj_text(model)).mesh;
  GltfWriter out;
  const std::string rest = one_node(primitive_of(out, model, {}));
  expect_same_mesh(files.load(out.glb(rest)).mesh, mesh);
}

TEST(Gltf, StripsFansAndCornersWithoutIndices) {
  const GltfFiles files;
  GltfWriter out;
  const std::size_t points = out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}, {3, 3, 3}});
  const std::size_t order = out.array(std::vector<std::uint8_t>{4, 3, 2, 1, 0}, kUint8, "SCALAR", 1);
  const auto corners = [&](const std::string& more) {
    return to_vector(files
                         .load(out.glb(one_node("{\"attributes\":{\"POSITION\":" + std::to_string(points) +
                                                "}" + more + "}")))
                         .mesh.indices);
  };
  using List = std::vector<std::uint32_t>;
  EXPECT_EQ(corners(""), (List{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(corners(",\"mode\":5"), (List{0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4}));
  EXPECT_EQ(corners(",\"mode\":6"), (List{1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0}));
  const std::string indices = ",\"indices\":" + std::to_string(order);
  EXPECT_EQ(corners(",\"mode\":5" + indices), (List{4, 3, 2, 3, 1, 2, 2, 1, 0}));
  EXPECT_EQ(corners(",\"mode\":6" + indices), (List{3, 2, 4, 2, 1, 4, 1, 0, 4}));
  EXPECT_EQ(corners(",\"mode\":1"), List{});
}

// glTF 2.0, 3.6.2.2: max(c / 127, -1) and the like.
TEST(Gltf, WholeNumbersStandForParts) {
  const GltfFiles files;
  const auto positions = [&](auto value, int number, bool normalized) {
    GltfWriter out;
    std::vector<decltype(value)> values(9);
    for (std::size_t i = 0; i < 9; ++i)
      values[i] = static_cast<decltype(value)>(value + static_cast<int>(i) * 7);
    out.array(values, number, "VEC3", 3, normalized ? ",\"normalized\":true" : "");
    const TriangleMesh mesh = files.load(out.glb(one_node("{\"attributes\":{\"POSITION\":0}}"))).mesh;
    double most = 1;
    if (normalized) most = number == kInt8 ? 127 : number == kUint8 ? 255 : number == kInt16 ? 32767 : 65535;
    for (std::size_t i = 0; i < 9; ++i) {
      const double expected = std::max(static_cast<double>(values[i]) / most, normalized ? -1.0 : -1e9);
      const int k = static_cast<int>(i % 3);
      EXPECT_EQ(static_cast<float>(mesh.origin[k] + static_cast<double>(mesh.positions[i / 3][k])),
                static_cast<float>(expected))
          << number;
    }
  };
  for (const bool normalized : {false, true}) {
    positions(std::int8_t{-128}, kInt8, normalized);
    positions(std::uint8_t{199}, kUint8, normalized);
    positions(std::int16_t{-32768}, kInt16, normalized);
    positions(std::uint16_t{65479}, kUint16, normalized);
  }
}

TEST(Gltf, SparseElementsReplaceOthers) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const std::size_t places = out.view(std::string("\x01\x00\x02\x00", 4));
  std::string values;
  for (const float x : {5.0f, 6.0f, 7.0f, 8.0f, 9.0f, 10.0f}) append_bytes(values, x);
  const std::size_t moved = out.view(values);
  const std::string sparse =
      ",\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":" + std::to_string(places) +
      ",\"componentType\":5123},\"values\":{\"bufferView\":" + std::to_string(moved) + "}}";
  out.accessor(0, kFloat, 3, "VEC3", sparse);
  out.accessors += ",{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"" + sparse + "}";
  const auto load = [&](const char* accessor) {
    return to_vector(
        files.load(out.glb(one_node(std::string("{\"attributes\":{\"POSITION\":") + accessor + "}}")))
            .mesh.positions);
  };
  EXPECT_EQ(load("0"), (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(load("1"), (std::vector<Vec3f>{{0, 0, 0}, {5, 6, 7}, {8, 9, 10}}));
  EXPECT_EQ(load("2"), load("1"));
}

// Of the elements that many meshes share, each takes its own.
TEST(Gltf, MeshesTakeWhatTheyUseOfSharedElements) {
  const GltfFiles files;
  GltfWriter out;
  std::vector<Vec3f> points;
  for (int i = 0; i < 20000; ++i) points.push_back({static_cast<float>(i), 1, 2});
  out.vectors(points), out.vectors(points);
  out.array(std::vector<std::uint16_t>{19999, 7, 300, 7, 19999, 2}, kUint16, "SCALAR", 1);
  const TriangleMesh mesh =
      files.load(out.glb(one_node("{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"indices\":2}"))).mesh;
  EXPECT_EQ(to_vector(mesh.positions),
            (std::vector<Vec3f>{{2, 1, 2}, {7, 1, 2}, {300, 1, 2}, {19999, 1, 2}}));
  EXPECT_EQ(to_vector(mesh.normals), to_vector(mesh.positions));
  EXPECT_EQ(to_vector(mesh.indices), (std::vector<std::uint32_t>{3, 1, 2, 1, 3, 0}));
  EXPECT_EQ(to_vector(mesh.normal_indices), to_vector(mesh.indices));
}

TEST(Gltf, PrimitivesAreOneMeshWithSlots) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  out.vectors({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
  out.array(std::vector<std::uint16_t>{2, 1, 0}, kUint16, "SCALAR", 1);
  out.vectors({{5, 0, 0}, {6, 0, 0}, {5, 1, 0}});
  const MeshFile file = files.load(
      out.glb("\"materials\":[{\"name\":\"a\"},{\"name\":\"b\"},{\"name\":\"c\"}]," +
              one_node("{\"attributes\":{\"POSITION\":0},\"material\":2},"
                       "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"indices\":2,\"material\":0},"
                       "{\"attributes\":{\"POSITION\":3,\"NORMAL\":1},\"material\":2}")));
  const TriangleMesh& m = file.mesh;
  EXPECT_EQ(m.positions.size(), 6u);
  EXPECT_EQ(m.normals.size(), 3u);
  EXPECT_EQ(to_vector(m.indices), (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 0, 3, 4, 5}));
  EXPECT_EQ(to_vector(m.normal_indices), (std::vector<std::uint32_t>{kNoId, kNoId, kNoId, 2, 1, 0, 0, 1, 2}));
  EXPECT_EQ(to_vector(m.material_slots), (std::vector<std::uint16_t>{0, 1, 0}));
  ASSERT_EQ(file.materials.size(), 2u);
  EXPECT_EQ(file.materials[0].name, "c");
  EXPECT_EQ(file.materials[1].name, "a");
}

}  // namespace
}  // namespace oktett::test::gltf_test
