#include "io/ply/ply.h"

#include "tests/io/ply_test_support.h"

namespace oktett::test::ply_test {
namespace {

// Every form has the columns of the OBJ file of the same mesh, bit for bit.
TEST(Ply, AllFormsEqualTheObj) {
  const PlyFiles files;
  std::mt19937 random(1);
  for (int i = 0; i < 150; ++i) {
    const bool corner_uvs = random() % 4 == 0;
    MeshModel model = random_model(random, random() % 2, !corner_uvs && random() % 2, corner_uvs);
    const ObjFile obj = files.files().load(obj_text(model));
    const TriangleMesh& mesh = obj.mesh;
    // Random faces may cross themselves; both formats say so.
    const bool crossing = std::ranges::any_of(
        obj.warnings, [](const Warning& w) { return w.message.find("cross") != std::string::npos; });
    const std::pair<const char*, const char*> names[] = {{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}};
    for (const PlyFormat format : kPlyFormats) {
      PlyStyle style{.format = format};
      style.number = random() % 2 ? PlyType::float32 : PlyType::float64;
      style.length = static_cast<PlyType>(random() % 6);
      style.index = static_cast<PlyType>(random() % 6);
      style.extras = random() % 2 == 0;
      style.faces_first = random() % 3 == 0;
      const auto& uv = names[random() % 3];
      style.uv[0] = uv.first, style.uv[1] = uv.second;
      const MeshReadOptions options{.chunk_bytes = random() % 2 ? 1 + random() % 300 : 1 << 20};
      const ParsedMesh parsed = files.parse_bytes(ply_bytes(model, style), options);
      expect_same_mesh(parsed.mesh, mesh);
      EXPECT_EQ(parsed.has_faces, !model.faces.empty());
      EXPECT_EQ(parsed.notices.size(), (style.extras ? 2u : 0u) + (crossing ? 1u : 0u));
    }
  }
}

TEST(Ply, ManyFacesGoToSeveralTasks) {
  const PlyFiles files;
  MeshModel model;
  for (int i = 0; i < 100000; ++i)
    model.positions.push_back({static_cast<float>(i), static_cast<float>(i % 7), 0});
  for (std::uint32_t i = 0; i + 3 < 100000; ++i) model.faces.push_back({{i, i + 1, i + 2}, {}});
  const TriangleMesh mesh = files.files().load(obj_text(model)).mesh;
  for (const PlyFormat format : kPlyFormats)
    expect_same_mesh(files.load(ply_bytes(model, {.format = format})).mesh, mesh);
  // A last face of another length.
  model.faces.push_back({{0, 1, 7, 13}, {}});
  const TriangleMesh longer = files.files().load(obj_text(model)).mesh;
  for (const PlyFormat format : kPlyFormats)
    expect_same_mesh(files.load(ply_bytes(model, {.format = format})).mesh, longer);
}

TEST(Ply, Strips) {
  const PlyFiles files;
  for (const PlyFormat format : kPlyFormats) {
    PlyWriter out(format);
    out.element("vertex", 5);
    for (const char* name : {"x", "y", "z"}) out.property(PlyType::int8, name);
    out.element("tristrips", 2);
    out.list(PlyType::int32, PlyType::int32, "vertex_indices");
    for (int i = 0; i < 5; ++i) {
      for (int k = 0; k < 3; ++k) out.value(PlyType::int8, i * k);
      out.end_record();
    }
    for (const std::vector<int>& strip :
         {std::vector{0, 1, 2, 3, 4, -1, 2, 3, -1, -1, 4, 1, 0}, std::vector{1, 2}}) {
      out.value(PlyType::int32, static_cast<double>(strip.size()));
      for (const int i : strip) out.value(PlyType::int32, i);
      out.end_record();
    }
    EXPECT_EQ(to_vector(files.load(out.bytes()).mesh.indices), (Indices{0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 1, 0}));
  }
}

TEST(Ply, HeadersOfOtherPrograms) {
  const PlyFiles files;
  const std::string header =
      "ply|format binary_little_endian 1.0|obj_info any text|comment|element vertex 3|"
      "property  float\tx|property float y|property float32 z|element face 1|"
      "property list uchar int vertex_index|end_header|";
  std::string body;
  // The first byte of the body looks like an end of line.
  const std::uint32_t bits = 0x3f80000au;
  for (int i = 0; i < 9; ++i) append_bytes(body, bits + static_cast<std::uint32_t>(i % 4) * 256);
  body += '\x03';
  for (const std::int32_t i : {2, 0, 1}) append_bytes(body, i);
  for (const std::string line_end : {"\n", "\r\n", "\r"}) {
    std::string bytes = header;
    for (std::size_t at; (at = bytes.find('|')) != std::string::npos;) bytes.replace(at, 1, line_end);
    const MeshFile file = files.load(bytes + body);
    ASSERT_EQ(file.mesh.positions.size(), 3u);
    // They lie close together, so a centre is taken off.
    for (std::size_t i = 0; i < 3; ++i) {
      Vec3f wanted;
      std::memcpy(&wanted, body.data() + 12 * i, sizeof wanted);
      EXPECT_EQ(file.mesh.origin + Vec3d(file.mesh.positions[i]), Vec3d(wanted));
    }
    EXPECT_EQ(to_vector(file.mesh.indices), (Indices{2, 0, 1}));
    EXPECT_TRUE(file.warnings.empty());
  }
}

TEST(Ply, WhatIsNotReadIsSaid) {
  const PlyFiles files;
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement edge 1\n"
      "property int a\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 1 2 3\n\n  1 0 0 1 2 3\n0 1 0 1 2 3\n5\n\nmore\n";
  EXPECT_EQ(files.warnings(text),
            (std::vector<std::string>{"a.ply:10:1: warning: element 'edge' is not read",
                                      "a.ply: warning: 1 lines behind the last element are not read"}));
  EXPECT_EQ(files.load(text).mesh.positions.size(), 3u);
  const MeshModel model{
      .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .normals = {}, .uvs = {}, .faces = {{{0, 1, 2}, {}}}};
  EXPECT_EQ(files.warnings(ply_bytes(model, {.format = PlyFormat::big_endian}) + "1234"),
            std::vector<std::string>{"a.ply: warning: 4 bytes behind the last element are not read"});
}

// Other programs read these files; a warning says what is left out.
TEST(Ply, OddHeadersAndFacesAreReadWithAWarning) {
  const PlyFiles files;
  const std::string body = "element face 2\nproperty list uchar int vertex_index\nend_header\n";
  const std::string points = "property float x\nproperty float y\nproperty float z\n";
  EXPECT_EQ(
      files.warnings("ply\nformat ascii 1.0\nCreated by Blender\nelement vertex 3\n" + points + body +
                     "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 2 1 0\n"),
      std::vector<std::string>{"a.ply:3:1: warning: the line is not read; expected 'comment', 'obj_info', "
                               "'format', 'element', 'property' or 'end_header'"});
  EXPECT_EQ(files.warnings("ply\nformat ascii 1.0\nelement vertex 3\n" + points +
                           "property float q\nproperty float q\n" + body +
                           "0 0 0 7 8\n1 0 0 7 8\n0 1 0 7 8\n3 0 1 2\n2 0 1\n"),
            (std::vector<std::string>{
                "a.ply:8:1: warning: element 'vertex' has a second property 'q'; the first counts",
                "a.ply:16:1: warning: a face of fewer than 3 corners is skipped"}));
  // The first x is the position.
  const MeshFile file = files.load("ply\nformat ascii 1.0\nelement vertex 3\n" + points +
                                   "property float x\n" + body + "0 0 0 7\n1 0 0 7\n0 1 0 7\n3 0 1 2\n0\n");
  EXPECT_EQ(file.mesh.positions[1], (Vec3f{1, 0, 0}));
  EXPECT_EQ(file.mesh.triangle_count(), 1u);
  EXPECT_EQ(
      files.warnings("ply\nformat ascii 1.0\nelement vertex 3\n" + points +
                     "property float nx\nproperty float ny\nproperty float nz\n" + body +
                     "0 0 0 nan nan nan\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n3 2 1 0\n"),
      std::vector<std::string>{"a.ply:3:1: warning: a normal is not finite: corners that have it show the "
                               "normal of their face"});
}

TEST(Ply, SmallFacesInBytesAreSkipped) {
  const PlyFiles files;
  for (const PlyFormat format : {PlyFormat::little_endian, PlyFormat::big_endian}) {
    MeshModel model;
    model.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    model.faces = {{{0, 1}, {}}, {{0, 1, 2}, {}}, {{}, {}}};
    const MeshFile file = files.load(ply_bytes(model, {.format = format}));
    EXPECT_EQ(file.mesh.triangle_count(), 1u);
    EXPECT_EQ(to_vector(file.mesh.indices), (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_EQ(file.warnings.size(), 1u);
  }
}

}  // namespace
}  // namespace oktett::test::ply_test
