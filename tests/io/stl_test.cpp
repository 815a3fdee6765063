#include "io/stl/stl.h"

#include "core/mesh_geometry.h"

#include "tests/io/mesh_test_support.h"

namespace oktett::test::stl_test {
namespace {

/// Faces of the model must be triangles.
std::string stl_bytes(const MeshModel& model, std::string header = "made by a test") {
  header.resize(80, ' ');
  std::string bytes = header;
  append_bytes(bytes, static_cast<std::uint32_t>(model.faces.size()));
  for (const MeshModel::Face& face : model.faces) {
    for (int k = 0; k < 3; ++k) append_bytes(bytes, NAN);
    for (const std::uint32_t corner : face.corners)
      for (const float x : {model.positions[corner].x, model.positions[corner].y, model.positions[corner].z})
        append_bytes(bytes, x);
    append_bytes(bytes, std::uint16_t{0xabcd});
  }
  return bytes;
}

std::string stl_text(const MeshModel& model) {
  std::string text = "solid some name\n";
  for (const MeshModel::Face& face : model.faces) {
    text += "  facet normal 0 nan 1e-3\n    outer loop\n";
    for (const std::uint32_t corner : face.corners) {
      const Vec3f& p = model.positions[corner];
      text += "      vertex " + exact_text(p.x) + "\t" + exact_text(p.y) + "  " + exact_text(p.z) + "\n";
    }
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid some name\n";
}

MeshModel random_triangles(std::mt19937& random) {
  MeshModel model = random_model(random, false, false, false);
  for (MeshModel::Face& face : model.faces) face.corners.resize(3);
  return model;
}

/// Corners of all triangles in turn.
std::vector<Vec3f> corners_of(const TriangleMesh& mesh) {
  std::vector<Vec3f> corners;
  for (const std::uint32_t index : mesh.indices) corners.push_back(mesh.positions[index]);
  return corners;
}
std::vector<Vec3f> corners_of(const MeshModel& model) {
  std::vector<Vec3f> corners;
  for (const MeshModel::Face& face : model.faces)
    for (const std::uint32_t corner : face.corners) corners.push_back(model.positions[corner]);
  return corners;
}

struct StlFiles : ParsedFiles<parse_stl> {
  StlFiles() : ParsedFiles("a.stl") {}
};

// Both forms have the triangles of the model, bit for bit, wherever the file is cut into chunks.
TEST(Stl, BothFormsHaveTheSameTriangles) {
  const StlFiles files;
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const MeshModel model = random_triangles(random);
    const MeshReadOptions options{.chunk_bytes = 1 + random() % 300};
    const ParsedMesh text = files.parse_bytes(stl_text(model), options);
    const ParsedMesh bytes = files.parse_bytes(stl_bytes(model), options);
    EXPECT_EQ(corners_of(text.mesh), corners_of(model));
    expect_same_mesh(text.mesh, bytes.mesh);
    EXPECT_EQ(text.has_faces, !model.faces.empty());
    EXPECT_TRUE(text.notices.empty() && bytes.notices.empty());
  }
}

// A welded mesh has each place once, in the order of first use, and the triangles of the file.
TEST(Stl, WeldingMakesOneVertexOfEachPlace) {
  const StlFiles files;
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    MeshModel model = random_triangles(random);
    // Many corners at few places, which differ in the sign of zeros, too.
    for (Vec3f& p : model.positions) {
      const auto coordinate = [&] {
        return static_cast<float>(static_cast<int>(random() % 4) - 1) * (random() % 2 ? 1.0f : -1.0f);
      };
      p = {coordinate(), coordinate(), coordinate()};
    }
    const MeshFile file = files.load(stl_bytes(model), {.weld = true});
    EXPECT_EQ(corners_of(file.mesh), corners_of(model));
    std::vector<Vec3f> places;
    for (const Vec3f& p : corners_of(model))
      if (std::find(places.begin(), places.end(), p) == places.end()) places.push_back(p);
    EXPECT_EQ(to_vector(file.mesh.positions), places);
  }
}

// Large enough for several tasks.
TEST(Stl, ManyTrianglesAreWelded) {
  constexpr int n = 300;
  MeshModel model;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x)
      model.positions.push_back({static_cast<float>(x), static_cast<float>(y), 0.5f});
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t i = y * (n + 1) + x;
      model.faces.push_back({{i, i + 1, i + n + 2}, {}});
      model.faces.push_back({{i, i + n + 2, i + n + 1}, {}});
    }
  const StlFiles files;
  const MeshFile file = files.load(stl_bytes(model), {.weld = true});
  EXPECT_EQ(file.mesh.positions.size(), model.positions.size());
  EXPECT_EQ(corners_of(file.mesh), corners_of(model));
  EXPECT_EQ(files.load(stl_bytes(model)).mesh.positions.size(), 3 * model.faces.size());
}

TEST(Stl, BytesMayBeginLikeText) {
  const StlFiles files;
  std::mt19937 random(3);
  MeshModel model = random_triangles(random);
  model.faces.resize(5, model.faces.empty() ? MeshModel::Face{{0, 1, 2}, {}} : model.faces[0]);
  for (const char* header : {"solid", "solid name\nfacet normal", " SOLID x"})
    EXPECT_EQ(corners_of(files.load(stl_bytes(model, header)).mesh), corners_of(model));
  // With something behind them, too, if the bytes cannot be text.
  const std::string longer = stl_bytes(model, "solid") + "xyz";
  EXPECT_EQ(corners_of(files.load(longer).mesh), corners_of(model));
  EXPECT_EQ(files.warnings(longer),
            std::vector<std::string>{"a.stl: warning: 3 bytes behind the last triangle are not read"});
}

TEST(Stl, TextOfOtherPrograms) {
  const StlFiles files;
  const std::string facet =
      "FACET NORMAL 0 0 1\r\nOUTER LOOP\r\nVERTEX 0 0 0\r\n\r\nVertex 1.5E0 0 0 \r\nvertex 0 1 0\r\n"
      "endloop\r\nEndFacet\r\n";
  const MeshFile file =
      files.load("\n solid\r\n" + facet + "endsolid\r\nsolid b\r\n" + facet + facet + "endsolid b");
  EXPECT_EQ(file.mesh.triangle_count(), 3u);
  EXPECT_EQ(corners_of(file.mesh)[1], (Vec3f{1.5f, 0, 0}));
  EXPECT_EQ(files.warnings("solid a\nendsolid a\n"), std::vector<std::string>{"a.stl: warning: no faces"});
}

TEST(Stl, DamagedTextIsRefused) {
  const StlFiles files;
  const std::string good =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
      "endfacet\nendsolid a\n";
  ASSERT_EQ(files.error(good), "no error");
  const auto with = [&](const std::string& part, const std::string& other) {
    std::string text = good;
    return files.error(text.replace(text.find(part), part.size(), other));
  };
  EXPECT_EQ(with("facet normal", "facet"), "a.stl:2:7: expected 'facet normal' or 'endsolid', found '0'");
  EXPECT_EQ(with("outer loop", "outer"), "a.stl:3:6: expected 'outer loop', found ''");
  EXPECT_EQ(with("vertex 1 0 0\n", ""), "a.stl:6:1: expected 'vertex', found 'endloop'");
  EXPECT_EQ(with("vertex 1 0 0", "vertex 1 0"), "a.stl:5:11: expected a number, found the end of the line");
  EXPECT_EQ(with("vertex 1 0 0", "vertex 1 0 0 0"), "a.stl:5:14: expected the end of the line, found '0'");
  EXPECT_EQ(with("vertex 1 0 0", "vertex nan 0 0"), "a.stl:5:8: expected a finite number, found 'nan'");
  EXPECT_EQ(with("vertex 1 0 0", "vertex 1 2e30 0"),
            "a.stl:5:10: coordinate out of range: '2e30' (magnitude at most 1e30)");
  EXPECT_EQ(with("vertex 1 0 0", "vertex 1 1e99 0"),
            "a.stl:5:10: expected a finite number, but '1e99' is out of range");
  EXPECT_EQ(with("vertex 1 0 0", "vertex 1 x 0"), "a.stl:5:10: expected a number, found 'x'");
  EXPECT_EQ(with("endloop", "vertex 2 2 2"), "a.stl:7:1: expected 'endloop', found 'vertex'");
  EXPECT_EQ(with("endsolid a\n", "endsolid a\nfacet"), "a.stl:10:1: expected 'solid', found 'facet'");
  EXPECT_EQ(with("endfacet", "endfacet\nendfacet"),
            "a.stl:9:1: expected 'facet normal' or 'endsolid', found 'endfacet'");
  EXPECT_EQ(files.error(good, {.max_elements = 2}), "a.stl: 3 vertices, but indices reach only 2");
}

// The message is the same wherever the file is cut into chunks.
TEST(Stl, ErrorsDoNotDependOnChunks) {
  const StlFiles files;
  std::mt19937 random(4);
  MeshModel model = random_triangles(random);
  while (model.faces.size() < 8) model = random_triangles(random);
  const std::string text = stl_text(model);
  for (int i = 0; i < 300; ++i) {
    std::string damaged = text;
    const std::size_t at = random() % damaged.size();
    if (random() % 2 == 0)
      damaged.erase(at, 1 + random() % 60);
    else
      damaged[at] = "xf0 \nv"[random() % 6];
    const std::string whole = files.error(damaged);
    EXPECT_EQ(files.error(damaged, {.chunk_bytes = 1 + random() % 200}), whole) << damaged;
  }
}

TEST(Stl, DamagedBytesAreRefused) {
  const StlFiles files;
  const MeshModel model{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                        .normals = {},
                        .uvs = {},
                        .faces = {{{0, 1, 2}, {}}, {{2, 1, 0}, {}}}};
  const std::string good = stl_bytes(model);
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_EQ(files.error(good.substr(0, size)),
              size < 84 ? "a.stl: expected text that begins with 'solid', or a header of 84 bytes; found " +
                              std::to_string(size) + " bytes"
                        : "a.stl: byte 80: 2 triangles take 184 bytes, but the file ends at byte " +
                              std::to_string(size));
  std::string bad = good;
  const float numbers[] = {NAN, INFINITY, 2e30f};
  const char* const messages[] = {"expected a finite number, found nan",
                                  "expected a finite number, found inf",
                                  "coordinate out of range: 2e+30 (magnitude at most 1e30)"};
  for (int i = 0; i < 3; ++i) {
    std::memcpy(bad.data() + 84 + 50 + 12 + 32, &numbers[i], 4);
    EXPECT_EQ(files.error(bad), std::string("a.stl: byte 178: ") + messages[i]);
  }
}

// Programs in use read more than the format allows; each gives the triangle and says where it is odd.
TEST(Stl, LooseTextIsReadWithAWarning) {
  const StlFiles files;
  const std::pair<std::string, std::string> cases[] = {
      {"solid a\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
       "a\n",
       "a.stl:2:6: warning: expected 'facet normal' or 'endsolid', found ''; read all the same"},
      {"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
       "0\nendloop\nendfacet\n",
       "a.stl:9:1: warning: expected 'facet normal' or 'endsolid', found the end of the file; read all the "
       "same"},
      {"solid a\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop "
       "endfacet\nendsolid a\n",
       "a.stl:3:1: warning: expected 'outer loop', found 'endsolid'; read all the same"},
      {"solid facet normal nan nan nan outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet "
       "endsolid",
       "a.stl:1:107: warning: expected 'facet normal' or 'endsolid', found the end of the file; read all the "
       "same"},
      {"solid a\n# by hand\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0 ; first\nvertex 1 0 0\nvertex 0 1 "
       "0\n"
       "endloop // done\nendfacet\nendsolid\n",
       "a.stl:2:1: warning: expected 'facet normal' or 'endsolid', found ''; read all the same"},
  };
  for (const auto& [text, warning] : cases) {
    EXPECT_EQ(files.error(text), "no error") << text;
    EXPECT_EQ(files.warnings(text), std::vector<std::string>{warning}) << text;
    const MeshFile file = files.load(text);
    ASSERT_EQ(file.mesh.triangle_count(), 1u) << text;
    EXPECT_EQ(corner(file.mesh, 0, 1), (Vec3d{1, 0, 0}));
    EXPECT_EQ(corner(file.mesh, 0, 2), (Vec3d{0, 1, 0}));
  }
}

TEST(Stl, CutShortAtEveryByte) {
  const StlFiles files;
  std::mt19937 random(5);
  MeshModel model = random_triangles(random);
  while (model.faces.size() < 2) model = random_triangles(random);
  std::string text = stl_text(model);
  text.resize(text.rfind("endfacet"));
  for (std::size_t size = 0; size < text.size(); ++size) {
    const std::string error = files.error(text.substr(0, size));
    // Between facets the file reads on as one without an end.
    if (error == "no error") {
      EXPECT_EQ(files.warnings(text.substr(0, size)).size(),
                1u + (files.load(text.substr(0, size)).mesh.triangle_count() == 0));
      continue;
    }
    EXPECT_TRUE(error.starts_with("a.stl:") && error.find("expected") != std::string::npos) << error;
  }
}

TEST(Stl, HugeCountsAllocateNothing) {
  const StlFiles files;
  std::string bytes(84, 'x');
  const std::uint32_t count = 0xffffffffu;
  std::memcpy(bytes.data() + 80, &count, 4);
  with_little_memory([&] {
    EXPECT_EQ(files.error(bytes),
              "a.stl: byte 80: 4294967295 triangles take 214748364834 bytes, but the file ends at byte 84");
  });
}

}  // namespace
}  // namespace oktett::test::stl_test
