// What vertices of glTF files carry: COLOR_n and _NAME of all types, by themselves and in meshes of several
// parts.

#ifdef OKTETT_HAVE_DRACO
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#endif
#ifdef OKTETT_HAVE_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/io/convert_test_support.h"
#include "tests/io/gltf_test_support.h"

namespace oktett::test::gltf_attributes_test {
namespace {

using nlohmann::json;

const MeshAttribute& carried(const TriangleMesh& mesh, const std::string& name) {
  const MeshAttribute* const found = find_attribute(mesh, name);
  if (found == nullptr) throw Error("the mesh has no attribute " + name);
  return *found;
}

std::vector<float> floats(const TriangleMesh& mesh, const std::string& name) {
  return to_vector(carried(mesh, name).floats);
}

/// The values at the corners of all triangles.
std::vector<float> at_corners(const TriangleMesh& mesh, const std::string& name) {
  const MeshAttribute& a = carried(mesh, name);
  std::vector<float> all;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i)
    for (std::uint32_t k = 0; k < a.components; ++k) all.push_back(corner_value(mesh, a, i / 3, i % 3, k));
  return all;
}

const std::vector<Vec3f> kTriangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

std::string primitive(const std::string& attributes, const std::string& more = "") {
  return "{\"attributes\":{" + attributes + "}" + more + "}";
}

template <class T>
void expect_type(int number, const std::array<const char*, 4>& types) {
  const GltfFiles files;
  for (std::size_t size = 1; size <= 4; ++size)
    for (const bool normalized : {false, true}) {
      // With a gap behind each element.
      const std::size_t stride = (size * sizeof(T) + 3) / 4 * 4 + 4;
      std::string bytes;
      std::vector<float> expected;
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < size; ++k) {
          const T value = static_cast<T>(std::numeric_limits<T>::lowest() / 3 + static_cast<T>(7 * i + k));
          append_bytes(bytes, value);
          const double most = static_cast<double>(std::numeric_limits<T>::max());
          const bool part = normalized && sizeof(T) < 4;
          expected.push_back(static_cast<float>(static_cast<double>(value) / (part ? most : 1)));
        }
        bytes.resize((i + 1) * stride);
      }
      GltfWriter out;
      out.vectors(kTriangle);
      out.accessor(out.view(bytes, stride), number, 3, types[size - 1],
                   normalized ? ",\"normalized\":true" : "");
      const TriangleMesh mesh = files.load(out.glb(one_node(primitive("\"POSITION\":0,\"_X\":1")))).mesh;
      EXPECT_EQ(carried(mesh, "X").components, size);
      EXPECT_EQ(carried(mesh, "X").domain, AttributeDomain::vertex);
      const std::vector<float> found = floats(mesh, "X");
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t i = 0; i < found.size(); ++i) EXPECT_FLOAT_EQ(found[i], expected[i]) << number;
    }
}

TEST(GltfAttributes, NumbersOfAllTypesAreRead) {
  constexpr std::array<const char*, 4> kTypes{"SCALAR", "VEC2", "VEC3", "VEC4"};
  expect_type<std::int8_t>(kInt8, kTypes), expect_type<std::uint8_t>(kUint8, kTypes);
  expect_type<std::int16_t>(kInt16, kTypes), expect_type<std::uint16_t>(kUint16, kTypes);
  expect_type<std::uint32_t>(kUint32, kTypes);
}

TEST(GltfAttributes, SparseOnesAreRead) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors(kTriangle);
  std::string indices, values;
  append_bytes(indices, std::uint16_t{2});
  for (const int x : {51, 102, 255, 0}) append_bytes(values, static_cast<std::uint8_t>(x));
  const std::size_t first = out.view(indices), second = out.view(values);
  const auto sparse = [&](int index) {
    return ",\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":" + std::to_string(first) +
           ",\"componentType\":" + std::to_string(index) +
           "},\"values\":{\"bufferView\":" + std::to_string(second) + "}}}";
  };
  const std::string zeros = "{\"componentType\":5121,\"normalized\":true,\"count\":3,\"type\":\"VEC3\"";
  GltfWriter other = out;
  out.accessors += "," + zeros + sparse(kUint16);
  const std::string rest = one_node(primitive("\"POSITION\":0,\"COLOR_0\":1"));
  EXPECT_EQ(floats(files.load(out.glb(rest)).mesh, "color"),
            (std::vector<float>{0, 0, 0, 0, 0, 0, 51 / 255.0f, 102 / 255.0f, 1}));
  // As 16 bits its index is the same, but the accessor has two elements only.
  other.accessors += "," + zeros + sparse(kUint16);
  other.binary[36] = 3;
  EXPECT_EQ(files.error(other.glb(rest)), "a.glb: accessors[1]: sparse element 3 is out of range: it has 3");
}

TEST(GltfAttributes, NamesAreThoseOfTheFile) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors(kTriangle);
  out.array(std::vector<float>(9, 0.5f), kFloat, "VEC3", 3);
  out.array(std::vector<float>{1, 2, 3}, kFloat, "SCALAR", 1);
  out.array(std::vector<float>(12, 1), kFloat, "MAT2", 4);
  out.array(std::vector<std::uint32_t>(9, 1), kUint32, "VEC3", 3);
  out.array(std::vector<float>(3, 1), 5124, "SCALAR", 1);
  const auto names = [&](const std::string& attributes) {
    std::map<std::string, std::uint32_t> found;
    for (const MeshAttribute& a :
         files.load(out.glb(one_node(primitive("\"POSITION\":0," + attributes)))).mesh.attributes)
      found[a.name] = a.components;
    return found;
  };
  using Names = std::map<std::string, std::uint32_t>;
  EXPECT_EQ(names("\"COLOR_0\":1,\"COLOR_1\":1,\"COLOR_12\":1,\"_COLOR_1\":2,\"_a b\":2,\"__x\":2"),
            (Names{{"color", 3}, {"color_1", 3}, {"color_12", 3}, {"COLOR_1", 1}, {"a b", 1}, {"_x", 1}}));
  EXPECT_EQ(names("\"COLOR_x\":1,\"COLOR_\":1,\"COLOR\":1,\"_\":1,\"JOINTS_0\":1,\"X\":1"), Names{});
  // Numbers that are called like colours are what they are.
  EXPECT_EQ(names("\"_color\":2,\"_colorful\":2"), (Names{{"color", 1}, {"colorful", 1}}));
  const auto warning = [&](const std::string& attributes) {
    const std::vector<std::string> all =
        files.warnings(out.glb(one_node(primitive("\"POSITION\":0," + attributes))));
    return all.size() == 1 ? all[0] : std::to_string(all.size()) + " warnings";
  };
  const std::string start = "a.glb: warning: meshes[0].primitives[0]: the attribute ";
  EXPECT_EQ(warning("\"COLOR_0\":1,\"_color\":2"),
            start + "'_color' is not read: another one is called 'color'");
  for (const char* const number : {"3", "5"})
    EXPECT_EQ(warning("\"_a\":" + std::string(number)),
              start + "'a' is not read: expected up to four numbers for each vertex");
  for (const char* const number : {"2", "4"})
    EXPECT_EQ(
        warning("\"COLOR_0\":" + std::string(number)),
        start +
            "'color' is not read: expected three or four floats or parts of 8 or 16 bits for each vertex");
}

TEST(GltfAttributes, PartsOfAMeshHaveTheirOwn) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors(kTriangle);
  out.array(std::vector<float>{1, 2, 3}, kFloat, "SCALAR", 1);
  out.array(std::vector<float>{4, 5, 6, 7, 8, 9}, kFloat, "VEC2", 2);
  out.array(std::vector<std::uint8_t>{2, 1, 0}, kUint8, "SCALAR", 1);
  const auto read = [&](const std::vector<std::string>& parts) {
    std::string all;
    for (const std::string& part : parts)
      all += (all.empty() ? "" : ",") + primitive("\"POSITION\":0" + part, ",\"indices\":3");
    return files.load(out.glb(one_node(all))).mesh;
  };
  // All share positions.
  const TriangleMesh same = read({",\"_a\":1", ",\"_a\":1"});
  EXPECT_EQ(carried(same, "a").domain, AttributeDomain::vertex);
  EXPECT_EQ(at_corners(same, "a"), (std::vector<float>{3, 2, 1, 3, 2, 1}));
  const TriangleMesh mixed = read({",\"_a\":1", ",\"_a\":2,\"_b\":1", ""});
  EXPECT_EQ(mixed.positions.size(), 3u);
  EXPECT_EQ(at_corners(mixed, "a"),
            (std::vector<float>{3, 0, 2, 0, 1, 0, 8, 9, 6, 7, 4, 5, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(at_corners(mixed, "b"), (std::vector<float>{0, 0, 0, 3, 2, 1, 0, 0, 0}));
}

TEST(GltfAttributes, FewVerticesOfManyAreRead) {
  const GltfFiles files;
  std::vector<Vec3f> points;
  std::vector<float> numbers;
  for (int i = 0; i < 5000; ++i) {
    points.push_back({static_cast<float>(i), static_cast<float>(i % 7), 0});
    numbers.push_back(static_cast<float>(3 * i));
  }
  GltfWriter out;
  out.vectors(points);
  out.array(numbers, kFloat, "SCALAR", 1);
  out.array(std::vector<std::uint16_t>{4000, 17, 300}, kUint16, "SCALAR", 1);
  const TriangleMesh mesh =
      files.load(out.glb(one_node(primitive("\"POSITION\":0,\"_a\":1", ",\"indices\":2")))).mesh;
  EXPECT_EQ(mesh.positions.size(), 3u);
  EXPECT_EQ(at_corners(mesh, "a"), (std::vector<float>{12000, 51, 900}));
}

TEST(GltfAttributes, ManyNodesAreOneMesh) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors(kTriangle);
  out.array(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1}, kFloat, "VEC3", 3);
  out.array(std::vector<float>{7, 8, 9}, kFloat, "SCALAR", 1);
  const std::string rest =
      "\"meshes\":[{\"primitives\":[" + primitive("\"POSITION\":0,\"COLOR_0\":1") + "]},{\"primitives\":[" +
      primitive("\"POSITION\":0,\"_a\":2") + "," + primitive("\"POSITION\":0") +
      "]}],\"nodes\":[{\"mesh\":0,\"scale\":[-1,1,1]},{\"mesh\":1,\"translation\":[1,0,0]},{\"mesh\":0}],"
      "\"scenes\":[{\"nodes\":[0,1,2]}]";
  const TriangleMesh mesh = files.load(out.glb(rest)).mesh;
  ASSERT_EQ(mesh.triangle_count(), 4u);
  // The values go with their points, also where a mirror turns corners around.
  const MeshAttribute &color = carried(mesh, "color"), &a = carried(mesh, "a");
  for (std::size_t i = 0; i < 12; ++i) {
    const Vec3f& p = mesh.positions[mesh.indices[i]];
    const bool second = i / 3 == 1 || i / 3 == 2;
    const std::size_t vertex = p.y == 1 ? 2 : (second ? p.x - 1 : std::abs(p.x)) > 0.5f ? 1 : 0;
    for (std::uint32_t k = 0; k < 3; ++k)
      EXPECT_EQ(corner_value(mesh, color, i / 3, i % 3, k), second || k == vertex ? 1 : 0) << i;
    EXPECT_EQ(corner_value(mesh, a, i / 3, i % 3, 0), i / 3 == 1 ? static_cast<float>(7 + vertex) : 0) << i;
  }
}

TEST(GltfAttributes, StayWithBentMeshes) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors(kTriangle);
  out.array(std::vector<float>{7, 8, 9}, kFloat, "SCALAR", 1);
  const TriangleMesh mesh =
      files
          .load(out.glb("\"meshes\":[{\"weights\":[1],\"primitives\":[" +
                        primitive("\"POSITION\":0,\"_a\":1", ",\"targets\":[{\"POSITION\":0}]") + "," +
                        primitive("\"POSITION\":0", ",\"targets\":[{\"POSITION\":0}]") +
                        "]}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]"))
          .mesh;
  ASSERT_EQ(mesh.positions.size(), 6u);
  EXPECT_EQ(mesh.positions[1], (Vec3f{2, 0, 0}));
  EXPECT_EQ(floats(mesh, "a"), (std::vector<float>{7, 8, 9, 0, 0, 0}));
}

TEST(GltfAttributes, TakeNoMoreMemoryThanTheFileJustifies) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors(std::vector<Vec3f>(50000, Vec3f{0, 0, 0}));
  // For which nothing stands in the file.
  out.accessors += ",{\"componentType\":5126,\"count\":50000,\"type\":\"VEC4\"}";
  std::string attributes = "\"POSITION\":0";
  for (int i = 0; i < 3000; ++i) attributes += ",\"_" + std::to_string(i) + "\":1";
  with_little_memory([&] {
    EXPECT_NE(files.error(out.glb(one_node(primitive(attributes)))).find("too many for"), std::string::npos);
  });
}

TEST(GltfAttributes, MaterialsAreTintedOnlyByColours) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors(kTriangle);
  out.array(std::vector<float>(9, 0.5f), kFloat, "VEC3", 3);
  const MeshFile file = files.load(
      out.glb("\"materials\":[{\"alphaMode\":\"BLEND\"},{}]," +
              one_node(primitive("\"POSITION\":0,\"COLOR_0\":1", ",\"material\":0") + "," +
                       primitive("\"POSITION\":0,\"_color\":1,\"COLOR_1\":1", ",\"material\":1"))));
  ASSERT_EQ(file.materials.size(), 2u);
  ASSERT_NE(file.materials[0].tint_texture, kNoId);
  EXPECT_EQ(file.textures[file.materials[0].tint_texture].attribute, "color");
  // Three numbers have no alpha.
  EXPECT_EQ(file.materials[0].tint_opacity_texture, kNoId);
  EXPECT_EQ(file.materials[1].tint_texture, kNoId);
  EXPECT_TRUE(file.warnings.empty());
}

TEST(GltfAttributes, WhatCannotBeShownIsSaid) {
  const GltfFiles files;
  files.files.write("a.png", "");
  GltfWriter out;
  out.vectors(kTriangle);
  out.array(std::vector<float>(12, 0.5f), kFloat, "VEC4", 4);
  out.array(std::vector<float>(6, 0.5f), kFloat, "VEC2", 2);
  const auto warnings = [&](const std::string& more) {
    return files.warnings(out.glb(
        "\"images\":[{\"uri\":\"a.png\"}],\"textures\":[{\"source\":0}],\"materials\":[{\"name\":\"m\","
        "\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}" +
        more + "}]," +
        one_node(primitive("\"POSITION\":0,\"COLOR_0\":1,\"TEXCOORD_0\":2", ",\"material\":0"))));
  };
  using Texts = std::vector<std::string>;
  EXPECT_EQ(warnings(",\"alphaMode\":\"BLEND\""), Texts{});
  EXPECT_EQ(
      warnings(",\"alphaMode\":\"MASK\""),
      (Texts{"a.glb: warning: material 'm': alpha of vertices is not shown beside that of an image where it "
             "masks"}));
  EXPECT_EQ(
      warnings(",\"extensions\":{\"KHR_materials_unlit\":{}}"),
      (Texts{"a.glb: warning: material 'm': colours of vertices are not shown beside the image of an unlit "
             "material"}));
}

// ---- Packed

#ifdef OKTETT_HAVE_MESHOPTIMIZER

TEST(GltfAttributes, MeshoptimizerPacksThem) {
  const GltfFiles files;
  std::vector<std::uint8_t> colors;
  for (std::size_t i = 0; i < 12; ++i) colors.push_back(static_cast<std::uint8_t>(21 * i));
  std::string packed(meshopt_encodeVertexBufferBound(3, 4), '\0');
  packed.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(packed.data()), packed.size(),
                                           colors.data(), 3, 4));
  GltfWriter out;
  out.vectors(kTriangle);
  while (out.binary.size() % 4 != 0) out.binary += '\0';
  const std::size_t offset = out.binary.size();
  out.binary += packed;
  out.buffers = "{\"byteLength\":" + std::to_string(out.binary.size()) +
                "},{\"byteLength\":12,\"extensions\":{\"EXT_meshopt_compression\":{\"fallback\":true}}}";
  out.views +=
      ",{\"buffer\":1,\"byteLength\":12,\"byteStride\":4,\"extensions\":{\"EXT_meshopt_compression\":{"
      "\"buffer\":0,"
      "\"byteOffset\":" +
      std::to_string(offset) + ",\"byteLength\":" + std::to_string(packed.size()) +
      ",\"count\":3,\"byteStride\":4,\"mode\":\"ATTRIBUTES\"}}}";
  out.accessor(1, kUint8, 3, "VEC4", ",\"normalized\":true");
  const TriangleMesh mesh = files
                                .load(out.glb("\"extensionsRequired\":[\"EXT_meshopt_compression\"]," +
                                              one_node(primitive("\"POSITION\":0,\"COLOR_0\":1"))))
                                .mesh;
  std::vector<float> expected;
  for (const std::uint8_t x : colors) expected.push_back(x / 255.0f);
  EXPECT_EQ(floats(mesh, "color"), expected);
}

#endif

#ifdef OKTETT_HAVE_DRACO

/// A tetrahedron whose points have colours of bytes, which say of themselves that they are parts or not, and
/// numbers of other types.
std::string draco_bytes(bool normalized) {
  constexpr int kFaces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  const Vec3f points[4] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  const std::uint8_t colors[4][4] = {{0, 51, 102, 255}, {51, 51, 0, 0}, {102, 0, 0, 51}, {255, 0, 51, 102}};
  const std::int16_t heats[4] = {-300, 5, 700, 20000};
  const float flows[4][2] = {{0.5f, 1}, {2, -3}, {1e9f, 0}, {7, 8}};
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(4);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int color = builder.AddAttribute(draco::GeometryAttribute::COLOR, 4, draco::DT_UINT8, normalized);
  const int heat = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 1, draco::DT_INT16);
  const int flow = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 2, draco::DT_FLOAT32);
  const int whole = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 1, draco::DT_INT32);
  const std::int32_t wholes[4] = {-1, 0, 1000000, 4};
  for (int i = 0; i < 4; ++i) {
    const auto face = draco::FaceIndex(static_cast<std::uint32_t>(i));
    const auto set = [&](int attribute, const auto* values) {
      builder.SetAttributeValuesForFace(attribute, face, &values[kFaces[i][0]], &values[kFaces[i][1]],
                                        &values[kFaces[i][2]]);
    };
    set(position, points), set(color, colors), set(heat, heats), set(flow, flows), set(whole, wholes);
  }
  const auto mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

TEST(GltfAttributes, DracoPacksThem) {
  const GltfFiles files;
  for (const bool normalized : {false, true}) {
    GltfWriter out;
    out.view(draco_bytes(normalized));
    const auto file = [&](const char* flow) {
      GltfWriter own = out;
      own.accessors =
          "{\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},{\"componentType\":5125,\"count\":12,"
          "\"type\":"
          "\"SCALAR\"},{\"componentType\":5121,\"normalized\":true,\"count\":4,\"type\":\"VEC4\"},"
          "{\"componentType\":5122,\"count\":4,\"type\":\"SCALAR\"},"
          "{\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
          "{\"componentType\":5121,\"count\":4,\"type\":\"VEC4\"}";
      return own.glb(
          "\"materials\":[{\"alphaMode\":\"BLEND\"}],\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]"
          "," +
          one_node(
              primitive("\"POSITION\":0,\"COLOR_0\":2,\"_bytes\":5,\"_heat\":3,\"_flow\":4,\"_beside\":3",
                        ",\"material\":0,\"indices\":1,\"extensions\":{\"KHR_draco_mesh_compression\":{"
                        "\"bufferView\":0,"
                        "\"attributes\":{\"POSITION\":0,\"COLOR_0\":1,\"_bytes\":1,\"_heat\":2,\"_whole\":4,"
                        "\"_flow\":" +
                            std::string(flow) + "}}}")));
    };
    const MeshFile read = files.load(file("3"));
    EXPECT_EQ(
        files.files.as_text(read.warnings),
        (std::vector<std::string>{"a.glb: warning: meshes[0].primitives[0]: the attribute 'beside' is not "
                                  "read: it stands beside Draco's data"}));
    ASSERT_EQ(read.materials.size(), 1u);
    EXPECT_NE(read.materials[0].tint_texture, kNoId);
    EXPECT_NE(read.materials[0].tint_opacity_texture, kNoId);
    std::size_t seen = 0;
    for (std::size_t i = 0; i < read.mesh.positions.size(); ++i) {
      const Vec3f& p = read.mesh.positions[i];
      const std::size_t point = p.x > 0.5f ? 1 : p.y > 0.5f ? 2 : p.z > 0.5f ? 3 : 0;
      seen |= std::size_t{1} << point;
      const auto value = [&](const char* name, std::uint32_t k) {
        return carried(read.mesh, name).value(i, k);
      };
      const std::uint8_t colors[4][4] = {
          {0, 51, 102, 255}, {51, 51, 0, 0}, {102, 0, 0, 51}, {255, 0, 51, 102}};
      for (std::uint32_t k = 0; k < 4; ++k) {
        EXPECT_EQ(value("color", k), colors[point][k] / 255.0f);
        EXPECT_EQ(value("bytes", k), colors[point][k]);
      }
      EXPECT_EQ(value("heat", 0), (std::array{-300, 5, 700, 20000})[point]);
      EXPECT_EQ(value("whole", 0), (std::array{-1, 0, 1000000, 4})[point]);
      EXPECT_EQ(value("flow", 1), (std::array{1, -3, 0, 8})[point]);
    }
    EXPECT_EQ(seen, 15u);
    EXPECT_EQ(files.error(file("9")), "a.glb: meshes[0].primitives[0]: its data hold no attribute 9");
  }
}

#endif

// ---- Written

class GlbAttributes : public Convert {
 protected:
  /// The attributes of each primitive, with the types of their accessors.
  std::vector<std::map<std::string, std::string>> written(const MeshFile& file) {
    losses = write_glb(files.dir.file("a.glb"), file);
    const std::string bytes = file_content(files.dir.file("a.glb"));
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + 12, 4);
    const json root = json::parse(bytes.substr(20, size));
    std::vector<std::map<std::string, std::string>> found;
    for (const json& one : root["meshes"][0]["primitives"]) {
      std::map<std::string, std::string>& attributes = found.emplace_back();
      for (const auto& [name, number] : one["attributes"].items()) {
        const json& accessor = root["accessors"][number.get<std::size_t>()];
        EXPECT_EQ(accessor["componentType"], kFloat);
        EXPECT_EQ(accessor["count"], root["accessors"][0]["count"]);
        attributes[name] = accessor["type"];
      }
    }
    return found;
  }

  static MeshFile triangle() {
    MeshFile file;
    for (const Vec3f& p : kTriangle) file.mesh.positions.push_back(p);
    for (const std::uint32_t i : {0u, 1u, 2u}) file.mesh.indices.push_back(i);
    return file;
  }
  static void add(MeshFile& file, const std::string& name, std::uint32_t components, float value,
                  AttributeDomain domain = AttributeDomain::vertex) {
    MeshAttribute a;
    a.name = name, a.components = components, a.domain = domain;
    a.floats = Column<float>(domain_size(file.mesh, domain) * components, value);
    file.mesh.attributes.push_back(std::move(a));
  }

  MeshLosses losses;
};

using Types = std::map<std::string, std::string>;

TEST_F(GlbAttributes, SetsOfColoursAreNumberedWithoutGaps) {
  MeshFile file = triangle();
  add(file, "color_2", 3, 0.5f), add(file, "color", 4, 1), add(file, "heat", 1, 70);
  add(file, "flow", 2, 1, AttributeDomain::face);
  EXPECT_EQ(written(file)[0], (Types{{"POSITION", "VEC3"},
                                     {"COLOR_0", "VEC4"},
                                     {"_color_2", "VEC3"},
                                     {"_heat", "SCALAR"},
                                     {"_flow", "VEC2"}}));
  EXPECT_TRUE(losses.empty());
  add(file, "color_1", 3, 0);
  EXPECT_EQ(written(file)[0].count("COLOR_2"), 1u);
  EXPECT_EQ(load("a.glb").mesh.attributes.size(), 5u);
}

TEST_F(GlbAttributes, WhatIsNoColourOfGltfIsANumber) {
  for (const float value : {1.25f, -0.5f}) {
    MeshFile file = triangle();
    add(file, "color", 3, value), add(file, "color_1", 3, 0.5f);
    EXPECT_EQ(written(file)[0], (Types{{"POSITION", "VEC3"}, {"_color", "VEC3"}, {"_color_1", "VEC3"}}));
    EXPECT_EQ(losses,
              (Losses{"changed: colours, which glTF has as three or four parts from 0 to 1; others do "
                      "not show them"}));
    EXPECT_EQ(floats(load("a.glb").mesh, "color"), std::vector<float>(9, value));
  }
  MeshFile file = triangle();
  add(file, "color", 3, HUGE_VALF), add(file, "a\n", 1, 1), add(file, "a_", 1, 2);
  EXPECT_EQ(written(file)[0],
            (Types{{"POSITION", "VEC3"}, {"COLOR_0", "VEC3"}, {"_a_", "SCALAR"}, {"_a__2", "SCALAR"}}));
  EXPECT_EQ(losses.size(), 3u);
  EXPECT_EQ(floats(load("a.glb").mesh, "color"), std::vector<float>(9, 0));
}

/// A material that shows an image without the colours is not multiplied by them.
TEST_F(GlbAttributes, ImagesKeepTheirColours) {
  MeshFile file = triangle();
  file.mesh.indices.push_back(0), file.mesh.indices.push_back(1), file.mesh.indices.push_back(2);
  file.mesh.material_slots.push_back(0), file.mesh.material_slots.push_back(1);
  add(file, "color", 3, 0.5f);
  file.materials.resize(2);
  file.materials[0].name = "a", file.materials[1].name = "b";
  file.textures.emplace_back().path = "none.png";
  file.materials[1].color_texture = 0;
  const auto parts = written(file);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].count("COLOR_0"), 1u);
  EXPECT_EQ(parts[1].count("COLOR_0"), 0u);
  EXPECT_EQ(parts[1].count("_color"), 1u);
  const MeshFile read = load("a.glb");
  EXPECT_NE(read.materials[0].tint_texture, kNoId);
  EXPECT_EQ(read.materials[1].tint_texture, kNoId);
  EXPECT_EQ(at_corners(read.mesh, "color"), std::vector<float>(18, 0.5f));
}

TEST_F(GlbAttributes, TintedMaterialsStayTinted) {
  GltfWriter out;
  out.vectors(kTriangle);
  out.array(std::vector<float>(12, 0.5f), kFloat, "VEC4", 4);
  for (const char* const more :
       {"", ",\"alphaMode\":\"BLEND\"", ",\"alphaMode\":\"MASK\",\"alphaCutoff\":0.25"}) {
    files.write("in.glb", out.glb("\"materials\":[{\"name\":\"m\"" + std::string(more) + "}]," +
                                  one_node(primitive("\"POSITION\":0,\"COLOR_0\":1", ",\"material\":0"))));
    const MeshFile before = load("in.glb");
    EXPECT_EQ(write_glb(files.dir.file("out.glb"), before), Losses{}) << more;
    const MeshFile after = load("out.glb");
    EXPECT_EQ(after.materials, before.materials) << more;
    EXPECT_EQ(after.textures, before.textures) << more;
  }
}

}  // namespace
}  // namespace oktett::test::gltf_attributes_test
