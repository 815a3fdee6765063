// Colours and other numbers that vertices and faces carry: read from PLY and OBJ, kept by conversions.

#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <map>

#include "io/mesh/vertices.h"
#include "io/obj/parsed_obj.h"
#include "io/obj/write_obj.h"
#include "tests/io/convert_test_support.h"
#include "tests/io/gltf_test_support.h"
#include "tests/io/ply_test_support.h"

namespace oktett::test::mesh_attributes_test {
namespace {

/// The curve of IEC 61966-2-1.
float linear_of(double part) {
  return static_cast<float>(part <= 0.04045 ? part / 12.92 : std::pow((part + 0.055) / 1.055, 2.4));
}

const MeshAttribute& attribute(const TriangleMesh& mesh, const std::string& name) {
  const MeshAttribute* const found = find_attribute(mesh, name);
  if (found == nullptr) throw Error("the mesh has no attribute " + name);
  return *found;
}

std::vector<float> values(const TriangleMesh& mesh, const std::string& name) {
  const MeshAttribute& a = attribute(mesh, name);
  std::vector<float> all;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::uint32_t k = 0; k < a.components; ++k) all.push_back(a.value(i, k));
  return all;
}

void expect_near(const std::vector<float>& found, const std::vector<float>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_LE(std::abs(found[i] - expected[i]), 4e-7f * std::abs(expected[i])) << i;
}

// ---- PLY

/// One property of vertices or faces and its value for each.
struct Numbers {
  std::string name;
  PlyType type;
  std::vector<double> values;
};

/// A quadrangle and a triangle, with numbers of five vertices and of two faces before and behind the rest.
std::string ply_with(PlyFormat format, const std::vector<Numbers>& vertices,
                     const std::vector<Numbers>& faces, bool ring = false) {
  PlyWriter out(format);
  out.element("vertex", 5);
  const auto split = [](std::size_t size) { return size / 2; };
  const auto describe = [&out](const std::vector<Numbers>& list, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) out.property(list[i].type, list[i].name);
  };
  const auto write = [&out](const std::vector<Numbers>& list, std::size_t from, std::size_t to,
                            std::size_t k) {
    for (std::size_t i = from; i < to; ++i) out.value(list[i].type, list[i].values[k]);
  };
  describe(vertices, 0, split(vertices.size()));
  for (const char* name : {"x", "y", "z"}) out.property(PlyType::float32, name);
  describe(vertices, split(vertices.size()), vertices.size());
  if (ring) out.list(PlyType::uint8, PlyType::int16, "ring");
  out.element("face", 2);
  describe(faces, 0, split(faces.size()));
  out.list(PlyType::uint8, PlyType::int32, "vertex_indices");
  describe(faces, split(faces.size()), faces.size());
  const float places[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 1}};
  for (std::size_t k = 0; k < 5; ++k) {
    write(vertices, 0, split(vertices.size()), k);
    for (const float x : {places[k][0], places[k][1], 0.0f}) out.value(PlyType::float32, x);
    write(vertices, split(vertices.size()), vertices.size(), k);
    if (ring) {
      out.value(PlyType::uint8, static_cast<double>(k));
      for (std::size_t i = 0; i < k; ++i) out.value(PlyType::int16, 7);
    }
    out.end_record();
  }
  const std::vector<std::vector<double>> corners{{0, 1, 2, 3}, {1, 4, 2}};
  for (std::size_t k = 0; k < 2; ++k) {
    write(faces, 0, split(faces.size()), k);
    out.value(PlyType::uint8, static_cast<double>(corners[k].size()));
    for (const double corner : corners[k]) out.value(PlyType::int32, corner);
    write(faces, split(faces.size()), faces.size(), k);
    out.end_record();
  }
  return out.bytes();
}

constexpr PlyFormat kFormats[] = {PlyFormat::ascii, PlyFormat::little_endian, PlyFormat::big_endian};

TEST(PlyAttributes, NumbersOfVerticesAndFacesKeepTheirNames) {
  const PlyFiles files;
  const std::vector<Numbers> vertices{{"quality", PlyType::float32, {0.5, -1, 1e-3, 7, 0}},
                                      {"label", PlyType::int32, {-3, 70000, 0, 1, 2}},
                                      {"time", PlyType::float64, {1, 2.5, 3, 4, 5}},
                                      {"flags", PlyType::uint8, {0, 255, 7, 8, 9}}};
  const std::vector<Numbers> faces{{"area", PlyType::float32, {2.25, -4}},
                                   {"part", PlyType::uint16, {40000, 3}},
                                   {"label", PlyType::int8, {-5, 6}}};
  for (const PlyFormat format : kFormats)
    for (const bool ring : {false, true})
      for (const std::size_t chunk : {std::size_t{1}, std::size_t{40}, std::size_t{1} << 20}) {
        const ParsedMesh parsed = files.parse_bytes(ply_with(format, vertices, faces, ring), {chunk});
        const TriangleMesh& mesh = parsed.mesh;
        EXPECT_TRUE(parsed.notices.empty());
        ASSERT_EQ(mesh.attributes.size(), 7u);
        ASSERT_EQ(mesh.triangle_count(), 3u);
        for (const Numbers& n : vertices) {
          EXPECT_EQ(attribute(mesh, n.name).domain, AttributeDomain::vertex);
          EXPECT_EQ(values(mesh, n.name), std::vector<float>(n.values.begin(), n.values.end())) << n.name;
        }
        // The first face is two triangles.
        const std::map<std::string, std::vector<float>> of_faces{
            {"area", {2.25f, 2.25f, -4}}, {"part", {40000, 40000, 3}}, {"face_label", {-5, -5, 6}}};
        for (const auto& [name, expected] : of_faces) {
          EXPECT_EQ(attribute(mesh, name).domain, AttributeDomain::face);
          EXPECT_EQ(values(mesh, name), expected) << name;
        }
      }
}

TEST(PlyAttributes, ColoursMeanWhatTheirWritersMean) {
  const PlyFiles files;
  const std::vector<double> levels{0, 64, 128, 200, 255}, part{0, 0.25, 0.5, 0.75, 1.5};
  const auto colors = [](PlyType type, std::vector<double> v, const std::array<const char*, 3>& names) {
    return std::vector<Numbers>{{names[0], type, v}, {names[1], type, v}, {names[2], type, v}};
  };
  constexpr std::array<const char*, 3> kRgb{"red", "green", "blue"},
      kDiffuse{"diffuse_red", "diffuse_green", "diffuse_blue"}, kShort{"r", "g", "b"};
  std::vector<float> of_bytes, of_words, of_floats, with_alpha;
  for (std::size_t i = 0; i < 5; ++i) {
    of_bytes.insert(of_bytes.end(), 3, linear_of(levels[i] / 255));
    of_words.insert(of_words.end(), 3, linear_of(levels[i] * 257 / 65535));
    of_floats.insert(of_floats.end(), 3, linear_of(part[i]));
    with_alpha.insert(with_alpha.end(), 3, linear_of(levels[i] / 255));
    with_alpha.push_back(static_cast<float>(levels[4 - i] / 255));
  }
  std::vector<double> words;
  for (const double x : levels) words.push_back(x * 257);
  for (const PlyFormat format : kFormats)
    for (const bool ring : {false, true}) {
      const auto read = [&](const std::vector<Numbers>& vertices) {
        return files.parse_bytes(ply_with(format, vertices, {}, ring)).mesh;
      };
      for (const auto& names : {kRgb, kDiffuse, kShort})
        expect_near(values(read(colors(PlyType::uint8, levels, names)), "color"), of_bytes);
      // Old programs write bytes as whole numbers.
      expect_near(values(read(colors(PlyType::int32, levels, kRgb)), "color"), of_bytes);
      expect_near(values(read(colors(PlyType::uint16, words, kRgb)), "color"), of_words);
      expect_near(values(read(colors(PlyType::float32, part, kRgb)), "color"), of_floats);
      std::vector<Numbers> alpha = colors(PlyType::uint8, levels, kRgb);
      alpha.push_back({"alpha", PlyType::uint8, {levels.rbegin(), levels.rend()}});
      EXPECT_EQ(attribute(read(alpha), "color").components, 4u);
      EXPECT_EQ(attribute(read(alpha), "color").srgb.size(), 20u);
      expect_near(values(read(alpha), "color"), with_alpha);
      alpha[3].type = PlyType::float32;
      for (double& x : alpha[3].values) x /= 255;
      expect_near(values(read(alpha), "color"), with_alpha);
    }
}

TEST(PlyAttributes, FacesHaveColoursToo) {
  const PlyFiles files;
  const std::vector<Numbers> rgb{{"red", PlyType::uint8, {255, 0}},
                                 {"green", PlyType::uint8, {0, 255}},
                                 {"blue", PlyType::uint8, {0, 0}}};
  const TriangleMesh mesh = files.parse_bytes(ply_with(PlyFormat::little_endian, {}, rgb)).mesh;
  EXPECT_EQ(attribute(mesh, "color").domain, AttributeDomain::face);
  EXPECT_EQ(values(mesh, "color"), (std::vector<float>{1, 0, 0, 1, 0, 0, 0, 1, 0}));
  std::vector<Numbers> vertices = rgb;
  for (Numbers& n : vertices) n.values.assign(5, 255);
  const TriangleMesh both = files.parse_bytes(ply_with(PlyFormat::ascii, vertices, rgb)).mesh;
  EXPECT_EQ(values(both, "color"), std::vector<float>(15, 1));
  EXPECT_EQ(values(both, "face_color"), (std::vector<float>{1, 0, 0, 1, 0, 0, 0, 1, 0}));
}

TEST(PlyAttributes, NumberedPropertiesAreTheComponentsOfOne) {
  const PlyFiles files;
  const auto names = [&](const std::vector<std::string>& properties) {
    std::string head =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    std::string values, all;
    for (const std::string& name : properties) {
      head += "property float " + name + "\n";
      values += std::string(" ") + name.back();
    }
    head += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    for (const char* place : {"0 0 0", "1 0 0", "0 1 0"}) head += place + values + "\n";
    for (const MeshAttribute& a : files.parse_bytes(head + "3 0 1 2\n").mesh.attributes) {
      all += a.name + ":" + std::to_string(a.components) + " ";
      for (std::uint32_t k = 0; k < a.components && a.components > 1; ++k)
        EXPECT_EQ(a.value(2, k), static_cast<float>(k)) << a.name;
    }
    return all;
  };
  EXPECT_EQ(names({"flow_0", "flow_1", "flow_2"}), "flow:3 ");
  EXPECT_EQ(names({"flow.0", "flow.1", "flow.2"}), "flow:3 ");
  EXPECT_EQ(names({"color_0", "color_1", "color_2", "red_2"}), "color:3 red_2:1 ");
  // Neither in order nor alike, and more than four.
  EXPECT_EQ(names({"flow_1", "flow_0"}), "flow_1:1 flow_0:1 ");
  EXPECT_EQ(names({"flow_0", "flow.1"}), "flow_0:1 flow.1:1 ");
  EXPECT_EQ(names({"_0", "_1"}), "_0:1 _1:1 ");
  EXPECT_EQ(names({"a_0", "a_1", "a_2", "a_3", "a_4"}), "a_0:1 a_1:1 a_2:1 a_3:1 a_4:1 ");
}

TEST(PlyAttributes, OddOnesAreNoErrors) {
  const PlyFiles files;
  const std::string start =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string end = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const auto read = [&](const std::string& properties, const std::string& a, const std::string& b) {
    return files.parse_bytes(start + properties + end + "0 0 0 " + a + "\n1 0 0 " + b + "\n0 1 0 " + a +
                             "\n3 0 1 2\n");
  };
  const ParsedMesh odd = read("property double huge\n", "1e300", "nan");
  EXPECT_EQ(values(odd.mesh, "huge")[0], HUGE_VALF);
  EXPECT_TRUE(std::isnan(values(odd.mesh, "huge")[1]));
  const ParsedMesh cut =
      read("property uchar red\nproperty uchar green\nproperty uchar blue\n", "300 -1 nan", "0.5 1 2");
  EXPECT_EQ(to_vector(attribute(cut.mesh, "color").srgb),
            (std::vector<std::uint8_t>{255, 0, 0, 0, 1, 2, 255, 0, 0}));
  EXPECT_EQ(files.error(start + "property float q\n" + end + "0 0 0 1\n1 0 0 x\n0 1 0 1\n3 0 1 2\n"),
            "a.ply:12:7: expected a number, found 'x'");
  // Vertices without faces are points, which show them.
  const ParsedMesh cloud =
      files.parse_bytes(start + "property float q\nend_header\n0 0 0 1\n1 0 0 2\n0 1 0 3\n");
  EXPECT_EQ(values(cloud.mesh, "q"), (std::vector<float>{1, 2, 3}));
}

TEST(PlyAttributes, TakeNoMoreMemoryThanTheFileJustifies) {
  const PlyFiles files;
  constexpr int kCorners = 100000, kNumbers = 900;
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list int int vertex_indices\n";
  for (int i = 0; i < kNumbers; ++i) text += "property float n" + std::to_string(i) + "\n";
  text += "end_header\n0 0 0\n1 0 0\n0 1 0\n" + std::to_string(kCorners);
  for (int i = 0; i < kCorners; ++i) text += " " + std::to_string(i % 3);
  for (int i = 0; i < kNumbers; ++i) text += " 1";
  with_little_memory([&] {
    const ParsedMesh parsed = files.parse_bytes(text + "\n");
    EXPECT_TRUE(parsed.mesh.attributes.empty());
    EXPECT_FALSE(parsed.notices.empty());
  });
}

TEST(PlyAttributes, ImagesAreThoseOfTheHeader) {
  const PlyFiles files;
  const std::string text =
      "ply\nformat ascii 1.0\ncomment TextureFile one two.png\ncomment TextureFile b.png\nelement vertex 3\n"
      "property float x\nproperty float y\nproperty float z\nelement face 4\n"
      "property list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int texnumber\n"
      "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0 1 1\n3 0 1 2 6 0 0 1 0 0 1 0\n"
      "3 0 1 2 6 0 0 1 0 0 1 -1\n3 0 1 2 6 0 0 1 0 0 1 9\n";
  const MeshFile file = files.load(text);
  EXPECT_TRUE(file.warnings.empty());
  ASSERT_EQ(file.materials.size(), 3u);
  ASSERT_EQ(file.textures.size(), 2u);
  EXPECT_EQ(files.files().without_directory(file.textures[0].path), "one two.png");
  EXPECT_EQ(file.materials[1].color_texture, 1u);
  EXPECT_EQ(file.materials[2].color_texture, kNoId);
  EXPECT_EQ(to_vector(file.mesh.material_slots), (std::vector<std::uint16_t>{1, 0, 2, 2}));
  EXPECT_TRUE(file.mesh.attributes.empty());
  // One image for all, by coordinates of vertices.
  const MeshFile one = files.load(
      "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nproperty float s\nproperty float t\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n");
  ASSERT_EQ(one.materials.size(), 1u);
  EXPECT_TRUE(one.mesh.material_slots.empty());
  // Lines have no place in images.
  const MeshFile lined = files.load(
      "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nproperty float s\nproperty float t\nelement face 1\n"
      "property list uchar int vertex_indices\nelement edge 1\nproperty int vertex1\nproperty int vertex2\n"
      "end_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n0 1\n");
  ASSERT_EQ(lined.materials.size(), 2u);
  EXPECT_EQ(lined.materials[1].color_texture, kNoId);
  EXPECT_TRUE(lined.mesh.material_slots.empty());
  EXPECT_EQ(to_vector(lined.strokes.material_slots), std::vector<std::uint16_t>{1});
  std::string bare = text;
  bare.replace(bare.find("texcoord"), 8, "somelist");
  EXPECT_EQ(files.warnings(bare),
            (std::vector<std::string>{
                "a.ply:3:21: warning: images are not shown: there are no texture coordinates"}));
}

// ---- OBJ

TEST(ObjAttributes, SixNumbersAreAPositionAndAColour) {
  const ObjFiles files;
  const auto read = [&](const std::string& text, std::size_t chunk = 1 << 20) {
    return load_obj(files.write("a.obj", text), {.chunk_bytes = chunk}).mesh;
  };
  // Six digits of bytes are these bytes; coarser numbers are what they are.
  const TriangleMesh bytes =
      read("v 0 0 0 1 0 0.501961\nv 1 0 0 0.0039216 0.250980 1\nv 0 1 0 0 0 0 # c\nf 1 2 3\n");
  EXPECT_EQ(to_vector(attribute(bytes, "color").srgb),
            (std::vector<std::uint8_t>{255, 0, 128, 1, 64, 255, 0, 0, 0}));
  const TriangleMesh floats = read("v 0 0 0 0.5 0 0.3\nv 1 0 0 0.1 0.2 1\nv 0 1 0 0 0 1.5\nf 1 2 3\n");
  std::vector<float> expected;
  for (const double x : {0.5, 0.0, 0.3, 0.1, 0.2, 1.0, 0.0, 0.0, 1.5}) expected.push_back(linear_of(x));
  expect_near(values(floats, "color"), expected);
  // Some write bytes.
  const TriangleMesh whole = read("v 0 0 0 255 0 7\nv 1 0 0 1 2 3\nv 0 1 0 0 0 0\nf 1 2 3\n");
  EXPECT_EQ(to_vector(attribute(whole, "color").srgb),
            (std::vector<std::uint8_t>{255, 0, 7, 1, 2, 3, 0, 0, 0}));
  // A weight, and what is no colour.
  for (const char* rest : {" 1", " 1 2", " 0 -1 0", " a b c", " 1 0 x", " # 1 0 0"})
    EXPECT_TRUE(read("v 0 0 0" + std::string(rest) + "\nv 1 0 0" + rest + "\nv 0 1 0" + rest + "\nf 1 2 3\n")
                    .attributes.empty())
        << rest;
  // Four numbers behind the position: alpha is not said by most, and left out.
  EXPECT_EQ(
      attribute(read("v 0 0 0 1 1 1 0.5\nv 1 0 0 1 1 1 1\nv 0 1 0 1 1 1 1\nf 1 2 3\n"), "color").components,
      3u);
}

TEST(ObjAttributes, DoNotDependOnHowTheFileIsCut) {
  std::mt19937 random(9);
  const ObjFiles files;
  for (int round = 0; round < 20; ++round) {
    std::string text;
    std::vector<float> expected;
    const int count = 3 + static_cast<int>(random() % 40);
    int without = 0;
    for (int i = 0; i < count; ++i) {
      text += "v " + std::to_string(i) + " 0 " + std::to_string(i * i);
      const bool colored = round % 4 == 0 || random() % 3 != 0;
      for (int k = 0; k < 3; ++k) {
        const float x = static_cast<float>(random() % 1000) / 1000 + 1e-4f;
        if (colored) text += " " + exact_text(x);
        expected.push_back(colored ? linear_of(x) : 1);
      }
      without += colored ? 0 : 1;
      text += i % 5 == 0 ? " \\\n\n" : "\n";
    }
    text += "f 1 2 3\nf 1 3 2\n";
    for (const std::size_t chunk : {std::size_t{1}, std::size_t{33}, std::size_t{1} << 20}) {
      const MeshFile file = load_obj(files.write("a.obj", text), {.chunk_bytes = chunk});
      if (without == count) continue;
      expect_near(values(file.mesh, "color"), expected);
      EXPECT_EQ(file.warnings.size(), without > 0 ? 1u : 0u);
    }
  }
}

TEST(ObjAttributes, TheCurveIsThatOfSrgb) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> any(0, 1);
  for (int i = 0; i < 200000; ++i) {
    const float x = i < 1025 ? static_cast<float>(i) / 1024 : any(random);
    const long double exact =
        x <= 0.04045f ? x / 12.92L : std::pow((static_cast<long double>(x) + 0.055L) / 1.055L, 2.4L);
    ASSERT_LE(std::abs(linear_of_obj_color(x) - exact), 0x1p-23L * exact) << x;
  }
}

TEST(ObjAttributes, FewDigitsBehindBytesAreKept) {
  const ObjFiles files;
  // The first colour could be one of bytes, the last could not; a number of 255 levels behind small ones.
  const std::string start = "v 0 0 0 1 0 0.501961\nv 1 0 0 0.00392157 0.25098039 1.0\n", end = "f 1 2 3\n";
  const auto read = [&](const std::string& third) {
    return load_obj(files.write("a.obj", start + "v 0 1 0 " + third + "\n" + end), {.chunk_bytes = 1 << 20})
        .mesh;
  };
  const std::vector<std::uint8_t> bytes{255, 0, 128, 1, 64, 255, 0, 0, 255};
  for (const char* third :
       {"0 0.000000 1", "0.0 0e0 1.0000000000", "0 0 1 0.5", "+0 -0 1", "0 \\\n 0 1", "0 0 1 # c"})
    EXPECT_EQ(to_vector(attribute(read(third), "color").srgb), bytes) << third;
  expect_near(values(read("0 0.3 1"), "color"), {1, 0, linear_of(0.501961), linear_of(0.00392157),
                                                 linear_of(0.25098039), 1, 0, linear_of(0.3), 1});
  EXPECT_FLOAT_EQ(values(read("2 0 1"), "color")[6], linear_of(2));
}

TEST(ObjAttributes, PolypaintIsRead) {
  const ObjFiles files;
  const std::string faces = "f 1 2 3\n";
  const MeshFile file = load_obj(
      files.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n#MRGB ffff0000ff00fF00\n#MRGB 000102AB\n" + faces),
      {.chunk_bytes = 1});
  EXPECT_EQ(to_vector(attribute(file.mesh, "color").srgb),
            (std::vector<std::uint8_t>{255, 0, 0, 0, 255, 0, 1, 2, 171}));
  EXPECT_TRUE(file.warnings.empty());
  EXPECT_EQ(
      files.warnings("v 0 0 0\nv 1 0 0\nv 0 1 0\n#MRGB ffff0000\n" + faces),
      (std::vector<std::string>{"mesh.obj:1:1: warning: 1 colours of '#MRGB' for 3 vertices are not read"}));
}

// ---- glTF

TEST(GltfAttributes, ColoursAreLinearOfAllTypes) {
  const GltfFiles files;
  const std::vector<Vec3f> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const auto read = [&](auto values, int number, const char* type, std::size_t components, const char* more) {
    GltfWriter out;
    out.vectors(corners);
    out.array(values, number, type, components, more);
    return files.load(out.glb(one_node("{\"attributes\":{\"POSITION\":0,\"COLOR_0\":1,\"_HEAT\":1}}"))).mesh;
  };
  const std::vector<float> floats{0.25f, 0.5f, 1, 0, 0.125f, 2, 0, 0, 0};
  EXPECT_EQ(values(read(floats, kFloat, "VEC3", 3, ""), "color"), floats);
  EXPECT_EQ(values(read(floats, kFloat, "VEC3", 3, ""), "HEAT"), floats);
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint16_t> words;
  std::vector<float> of_bytes, of_words;
  for (int i = 0; i < 12; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(20 * i)), of_bytes.push_back(20 * i / 255.0f);
    words.push_back(static_cast<std::uint16_t>(5000 * i)), of_words.push_back(5000 * i / 65535.0f);
  }
  for (const char* more : {",\"normalized\":true", ""}) {
    const TriangleMesh mesh = read(bytes, kUint8, "VEC4", 4, more);
    EXPECT_EQ(attribute(mesh, "color").components, 4u);
    EXPECT_EQ(values(mesh, "color"), of_bytes);
    EXPECT_EQ(values(read(words, kUint16, "VEC4", 4, more), "color"), of_words);
  }
  // Others are what they are.
  EXPECT_EQ(values(read(bytes, kUint8, "VEC4", 4, ""), "HEAT")[5], 100);
}

TEST(GltfAttributes, PartsWithoutColoursAreWhite) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  out.array(std::vector<float>{0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f, 0.8f, 0.9f}, kFloat, "VEC3", 3);
  out.vectors({{5, 0, 0}, {6, 0, 0}, {5, 1, 0}});
  out.array(std::vector<float>{1, 2}, kFloat, "SCALAR", 1);
  const auto primitive = [](const char* attributes) {
    return "{\"attributes\":{" + std::string(attributes) + "}}";
  };
  const std::string with = primitive("\"POSITION\":0,\"COLOR_0\":1"), other = primitive("\"POSITION\":2");
  const TriangleMesh apart = files.load(out.glb(one_node(with + "," + other))).mesh;
  EXPECT_EQ(attribute(apart, "color").domain, AttributeDomain::vertex);
  const std::vector<float> expected{0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f, 0.8f, 0.9f,
                                    1,    1,    1,    1,    1,    1,    1,    1,    1};
  EXPECT_EQ(values(apart, "color"), expected);
  // The same positions with colours and without.
  const TriangleMesh shared = files.load(out.glb(one_node(with + "," + primitive("\"POSITION\":0")))).mesh;
  EXPECT_EQ(shared.positions.size(), 3u);
  EXPECT_EQ(attribute(shared, "color").domain, AttributeDomain::corner);
  EXPECT_EQ(values(shared, "color"), expected);
  EXPECT_EQ(
      files.warnings(out.glb(one_node(primitive("\"POSITION\":0,\"_A\":3")))),
      (std::vector<std::string>{"a.glb: warning: meshes[0].primitives[0]: the attribute 'A' is not read: "
                                "expected up to four numbers for each vertex"}));
}

TEST(GltfAttributes, MaterialsAreTinted) {
  const GltfFiles files;
  GltfWriter out;
  out.vectors({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  out.array(std::vector<float>(12, 0.5f), kFloat, "VEC4", 4);
  const auto material = [&](const std::string& json) {
    return files
        .load(out.glb("\"materials\":[" + json + "]," +
                      one_node("{\"material\":0,\"attributes\":{\"POSITION\":0,\"COLOR_0\":1}}")))
        .materials.at(0);
  };
  const Material plain = material("{}");
  EXPECT_NE(plain.tint_texture, kNoId);
  EXPECT_EQ(plain.color_texture, kNoId);
  EXPECT_EQ(plain.tint_opacity_texture, kNoId);
  EXPECT_NE(material("{\"alphaMode\":\"BLEND\"}").tint_opacity_texture, kNoId);
  EXPECT_NE(material("{\"alphaMode\":\"MASK\"}").opacity_texture, kNoId);
  const Material unlit = material("{\"extensions\":{\"KHR_materials_unlit\":{}}}");
  EXPECT_NE(unlit.emission_texture, kNoId);
}

// ---- Conversions

/// A mesh of random triangles with attributes of all kinds.
MeshFile random_mesh(std::mt19937& random, bool corners) {
  std::normal_distribution<float> normal;
  MeshFile file;
  TriangleMesh& mesh = file.mesh;
  const std::size_t count = 3 + random() % 20, triangles = 1 + random() % 30;
  for (std::size_t i = 0; i < count; ++i)
    mesh.positions.push_back({normal(random), normal(random), normal(random)});
  for (std::size_t i = 0; i < 3 * triangles; ++i)
    mesh.indices.push_back(static_cast<std::uint32_t>(random() % count));
  const auto add = [&](const char* name, AttributeDomain domain, std::uint32_t components, bool bytes) {
    MeshAttribute a;
    a.name = name, a.domain = domain, a.components = components;
    for (std::size_t i = domain_size(mesh, domain) * components; i > 0; --i)
      bytes ? a.srgb.push_back(static_cast<std::uint8_t>(random() % 3 * 100))
            : a.floats.push_back(std::abs(normal(random)));
    mesh.attributes.push_back(std::move(a));
  };
  add("color", AttributeDomain::vertex, 3 + random() % 2, random() % 2 == 0);
  add("heat", AttributeDomain::vertex, 1, false);
  add("flow", AttributeDomain::vertex, 2 + random() % 3, false);
  add("face_color", AttributeDomain::face, 3, random() % 2 == 0);
  add("label", AttributeDomain::face, 1, false);
  if (corners) add("wedge", AttributeDomain::corner, 2, false), add("tint", AttributeDomain::corner, 3, true);
  return file;
}

void expect_same_attributes(const TriangleMesh& a, const TriangleMesh& b) {
  ASSERT_EQ(a.attributes.size(), b.attributes.size());
  for (std::size_t i = 0; i < a.attributes.size(); ++i) {
    const MeshAttribute &one = a.attributes[i], &other = b.attributes[i];
    EXPECT_EQ(one.name, other.name);
    EXPECT_EQ(one.domain, other.domain) << one.name;
    EXPECT_EQ(one.components, other.components) << one.name;
    EXPECT_TRUE(same_bytes(one.floats, other.floats)) << one.name;
    EXPECT_TRUE(same_bytes(one.srgb, other.srgb)) << one.name;
  }
}

/// The bits of all attributes at a corner, by name.
std::map<std::string, std::vector<std::uint32_t>> at_corner(const TriangleMesh& mesh, std::size_t corner) {
  std::map<std::string, std::vector<std::uint32_t>> all;
  for (const MeshAttribute& a : mesh.attributes)
    for (std::uint32_t k = 0; k < a.components; ++k)
      all[a.name].push_back(std::bit_cast<std::uint32_t>(corner_value(mesh, a, corner / 3, corner % 3, k)));
  return all;
}

TEST_F(Convert, KeepsAttributesOfRandomMeshes) {
  std::mt19937 random(7);
  for (int round = 0; round < 40; ++round) {
    const MeshFile file = random_mesh(random, false);
    for (const bool ascii : {false, true}) {
      EXPECT_EQ(write_ply(files.dir.file("a.ply"), file, ascii), Losses{});
      // Some readers drop other signs from names, and then find none.
      const std::string text = file_content(files.dir.file("a.ply"));
      for (std::size_t at = 0; (at = text.find("\nproperty ", at)) < text.find("end_header"); ++at) {
        const std::string line = text.substr(at + 1, text.find('\n', at + 1) - at - 1);
        EXPECT_EQ(line.find_first_not_of("abcdefghijklmnopqrstuvwxyz_0123456789 "), std::string::npos)
            << line;
      }
      const MeshFile read = load("a.ply");
      EXPECT_TRUE(read.warnings.empty());
      expect_same_mesh(read.mesh, file.mesh);
      // Faces have theirs behind those of vertices.
      expect_same_attributes(read.mesh, file.mesh);
    }
    // Values of corners are those of vertices that are split.
    const MeshFile wedges = random_mesh(random, true);
    write_ply(files.dir.file("b.ply"), wedges, false);
    const MeshFile read = load("b.ply");
    ASSERT_EQ(read.mesh.indices.size(), wedges.mesh.indices.size());
    for (std::size_t i = 0; i < read.mesh.indices.size(); ++i) {
      EXPECT_EQ(read.mesh.positions[read.mesh.indices[i]], wedges.mesh.positions[wedges.mesh.indices[i]]);
      auto found = at_corner(read.mesh, i);
      auto expected = at_corner(wedges.mesh, i);
      EXPECT_EQ(found, expected);
    }
  }
}

/// A GLB file has values at vertices, and colours as floats.
TEST_F(Convert, KeepsAttributesInGlb) {
  std::mt19937 random(11);
  for (int round = 0; round < 20; ++round) {
    const MeshFile file = random_mesh(random, round % 2 == 0);
    write_glb(files.dir.file("a.glb"), file);
    const MeshFile read = load("a.glb");
    ASSERT_EQ(read.mesh.indices.size(), file.mesh.indices.size());
    for (std::size_t i = 0; i < read.mesh.indices.size(); ++i)
      EXPECT_EQ(at_corner(read.mesh, i), at_corner(file.mesh, i));
    // What GLB says it says again.
    write_glb(files.dir.file("b.glb"), read);
    expect_same_mesh(load("b.glb").mesh, read.mesh);
    expect_same_attributes(load("b.glb").mesh, read.mesh);
  }
}

TEST_F(Convert, KeepsColoursInObj) {
  std::mt19937 random(8);
  for (int round = 0; round < 20; ++round) {
    MeshFile file = random_mesh(random, false);
    file.mesh.attributes.resize(1);
    file.mesh.attributes[0].components = 3;
    const std::size_t size = 3 * file.mesh.positions.size();
    Column<float>& floats = file.mesh.attributes[0].floats;
    if (!floats.empty()) floats.resize_uninitialized(size);
    if (floats.empty()) file.mesh.attributes[0].srgb.resize_uninitialized(size);
    const bool floating = !floats.empty();
    EXPECT_EQ(write_obj(files.dir.file("a.obj"), file).size(), floating ? 1u : 0u);
    const MeshFile read = load("a.obj");
    expect_same_mesh(read.mesh, file.mesh);
    if (!floating) expect_same_attributes(read.mesh, file.mesh);
    // The curve is steep: not every float is that of another.
    expect_near(values(read.mesh, "color"), values(file.mesh, "color"));
  }
}

TEST_F(Convert, KeepsImagesThatPlyNames) {
  files.write("one two.png", ""), files.write("b.png", "");
  const std::string start =
      "ply\nformat ascii 1.0\ncomment TextureFile one two.png\ncomment TextureFile b.png\nelement vertex 3\n"
      "property float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n"
      "element face 3\nproperty list uchar int vertex_indices\n";
  const std::string body = "end_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n";
  files.write("a.ply", start + "property int texnumber\n" + body + "3 0 1 2 1\n3 0 1 2 0\n3 0 1 2 -1\n");
  std::filesystem::create_directory(files.dir.file("folder"));
  EXPECT_EQ(convert("a.ply", "folder/b.ply"), Losses{});
  const MeshFile a = load("a.ply"), b = load("folder/b.ply");
  EXPECT_EQ(to_vector(b.mesh.material_slots), to_vector(a.mesh.material_slots));
  ASSERT_EQ(b.textures.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_TRUE(std::filesystem::equivalent(a.textures[i].path, b.textures[i].path));
  EXPECT_EQ(convert("folder/b.ply", "c.ply", {.ascii = true}), Losses{});
  EXPECT_EQ(load("c.ply").textures, a.textures);
  // Formats with materials say them there.
  EXPECT_EQ(convert("a.ply", "a.obj"), Losses{});
  EXPECT_EQ(to_vector(load("a.obj").mesh.material_slots).size(), 3u);
}

TEST_F(Convert, NamesAttributesThatAreLost) {
  std::mt19937 random(1);
  write_ply(files.dir.file("a.ply"), random_mesh(random, false), false);
  EXPECT_EQ(convert("a.ply", "b.ply"), Losses{});
  const Losses obj = convert("a.ply", "a.obj"), stl = convert("a.ply", "a.stl");
  for (const char* name : {"heat", "flow", "label", "face_color"}) {
    const std::string line = std::string("lost: the attribute '") + name + "'";
    EXPECT_EQ(std::count(obj.begin(), obj.end(), line), 1) << name;
    EXPECT_EQ(std::count(stl.begin(), stl.end(), line), 1) << name;
  }
  EXPECT_EQ(std::count(obj.begin(), obj.end(), "lost: the attribute 'color'"), 0);
  EXPECT_EQ(std::count(stl.begin(), stl.end(), "lost: the attribute 'color'"), 1);
}

TEST(WeldAttributes, KeepsWhatDiffersAtCorners) {
  std::mt19937 random(2);
  for (int round = 0; round < 30; ++round) {
    MeshFile file = random_mesh(random, true);
    for (Vec3f& p : file.mesh.positions) p = {std::round(p.x), std::round(p.y), 0};
    // One that is the same wherever vertices are.
    MeshAttribute same;
    same.name = "place";
    for (const Vec3f& p : file.mesh.positions) same.floats.push_back(4 * p.x + p.y + 0.5f);
    for (Vec3f& p : file.mesh.positions) p.z = random() % 2 == 0 ? 0.0f : -0.0f;
    file.mesh.attributes.push_back(same);
    TriangleMesh welded = file.mesh;
    weld_positions(welded);
    EXPECT_EQ(attribute(welded, "place").domain, AttributeDomain::vertex);
    for (const MeshAttribute& a : welded.attributes) EXPECT_EQ(a.size(), domain_size(welded, a.domain));
    for (std::size_t i = 0; i < welded.indices.size(); ++i)
      EXPECT_EQ(at_corner(welded, i), at_corner(file.mesh, i));
  }
}

}  // namespace
}  // namespace oktett::test::mesh_attributes_test
