#include "io/obj/obj.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/io/obj_test_support.h"

namespace oktett::test::obj_test {
namespace {

const std::string kAttributes = "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nvn 0 1 0\nvn 1 0 0\n";

TEST(Obj, ReadsVerticesAndTriangles) {
  const ObjFile file = ObjFiles().load("v 0 0 0\nv 1.5 -.25 2e-1\nv +3 4. -5E+2\nf 1 2 3\n");
  EXPECT_EQ(to_vector(file.mesh.positions),
            (std::vector<Vec3f>{{0, 0, 0}, {1.5f, -0.25f, 0.2f}, {3, 4, -500}}));
  EXPECT_EQ(indices_of(file), (Indices{0, 1, 2}));
  EXPECT_TRUE(file.mesh.normals.empty());
  EXPECT_TRUE(file.mesh.uvs.empty());
  EXPECT_TRUE(file.mesh.normal_indices.empty());
  EXPECT_TRUE(file.mesh.uv_indices.empty());
  EXPECT_TRUE(file.mesh.material_slots.empty());
  EXPECT_TRUE(file.materials.empty());
  EXPECT_TRUE(file.warnings.empty());
}

TEST(Obj, IgnoresWeightsAndColorsOfVertices) {
  const ObjFile file = ObjFiles().load("v 1 2 3 0.5\nv 4 5 6 .1 .2 .3\nv 7 8 9\nf 1 2 3\n");
  EXPECT_EQ(to_vector(file.mesh.positions), (std::vector<Vec3f>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
}

TEST(Obj, ReadsTheFourFormsOfCorners) {
  const ObjFiles files;
  const ObjFile plain = files.load(kSquare + kAttributes + "f 1 2 3\n");
  EXPECT_TRUE(plain.mesh.uv_indices.empty());
  EXPECT_TRUE(plain.mesh.normal_indices.empty());

  const ObjFile with_uv = files.load(kSquare + kAttributes + "f 1/3 2/1 3/2\n");
  EXPECT_EQ(indices_of(with_uv), (Indices{0, 1, 2}));
  EXPECT_EQ(to_vector(with_uv.mesh.uv_indices), (Indices{2, 0, 1}));
  EXPECT_TRUE(with_uv.mesh.normal_indices.empty());

  const ObjFile with_normal = files.load(kSquare + kAttributes + "f 1//3 2//1 3//2\n");
  EXPECT_TRUE(with_normal.mesh.uv_indices.empty());
  EXPECT_EQ(to_vector(with_normal.mesh.normal_indices), (Indices{2, 0, 1}));

  const ObjFile with_both = files.load(kSquare + kAttributes + "f 4/1/3 2/2/2 3/3/1\n");
  EXPECT_EQ(indices_of(with_both), (Indices{3, 1, 2}));
  EXPECT_EQ(to_vector(with_both.mesh.uv_indices), (Indices{0, 1, 2}));
  EXPECT_EQ(to_vector(with_both.mesh.normal_indices), (Indices{2, 1, 0}));
}

TEST(Obj, MarksCornersWithoutUvOrNormal) {
  const ObjFile file = ObjFiles().load(kSquare + kAttributes + "f 1 2 3\nf 1/1 2//2 3/3/3\n");
  EXPECT_EQ(to_vector(file.mesh.uv_indices), (Indices{kNoId, kNoId, kNoId, 0, kNoId, 2}));
  EXPECT_EQ(to_vector(file.mesh.normal_indices), (Indices{kNoId, kNoId, kNoId, kNoId, 1, 2}));
}

TEST(Obj, ToleratesTrailingSlashes) {
  const ObjFile file = ObjFiles().load(kSquare + kAttributes + "f 1/ 2// 3/1/\n");
  EXPECT_EQ(indices_of(file), (Indices{0, 1, 2}));
  EXPECT_EQ(to_vector(file.mesh.uv_indices), (Indices{kNoId, kNoId, 0}));
  EXPECT_TRUE(file.mesh.normal_indices.empty());
}

TEST(Obj, ReadsUvsOfOneToThreeNumbersAndNormals) {
  const ObjFile file =
      ObjFiles().load("vt 0.25\nvt 0.5 0.75\nvt 1 2 3\nvn 0 0 2\nvn nan 0 -1.#IND00\nvn 0 0 0\n");
  EXPECT_EQ(to_vector(file.mesh.uvs), (std::vector<Vec2f>{{0.25f, 0}, {0.5f, 0.75f}, {1, 2}}));
  ASSERT_EQ(file.mesh.normals.size(), 3u);
  EXPECT_EQ(file.mesh.normals[0], (Vec3f{0, 0, 2}));
  EXPECT_TRUE(std::isnan(file.mesh.normals[1].x));
  EXPECT_TRUE(std::isnan(file.mesh.normals[1].z));
  EXPECT_EQ(file.mesh.normals[2], (Vec3f{0, 0, 0}));
}

TEST(Obj, NegativeIndicesCountFromTheRunningEnd) {
  const ObjFile file = ObjFiles().load(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf -3/-1/-1 -2/-1/-1 -1/-1/-1\n"
      "v 0 0 1\nvt 1 1\nvn 1 0 0\nf -4 -3/-2/-2 -1/-1/-1\n");
  EXPECT_EQ(indices_of(file), (Indices{0, 1, 2, 0, 1, 3}));
  EXPECT_EQ(to_vector(file.mesh.uv_indices), (Indices{0, 0, 0, kNoId, 0, 1}));
  EXPECT_EQ(to_vector(file.mesh.normal_indices), (Indices{0, 0, 0, kNoId, 0, 1}));
}

TEST(Obj, FacesMayComeBeforeTheirVertices) {
  EXPECT_EQ(indices_of(ObjFiles().load("f 1 2 3 4\n" + kSquare)), (Indices{0, 1, 2, 0, 2, 3}));
}

TEST(Obj, LinesMayEndInAnyWay) {
  const ObjFiles files;
  const std::string text = kSquare + "\n  \n# comment\nf 1 2 3\nf 1 3 4";
  const Indices expected{0, 1, 2, 0, 2, 3};
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string changed;
    for (const char c : text) changed += c == '\n' ? end : std::string(1, c);
    EXPECT_EQ(indices_of(files.load(changed)), expected);
    EXPECT_EQ(indices_of(files.load(changed + end)), expected);
  }
}

TEST(Obj, BlanksTabsAndCommentsMayStandAnywhere) {
  const ObjFile file = ObjFiles().load(
      "\xef\xbb\xbf# a file with a byte order mark\n \t v\t0  0 0 \t\nv 1 0 0# close by\n\tv 0 1 0 # apart\n"
      "  # indented\n\n   f  1\t2 3  # a triangle 4\nf 1 2 3#\n");
  EXPECT_EQ(file.mesh.positions.size(), 3u);
  EXPECT_EQ(indices_of(file), (Indices{0, 1, 2, 0, 1, 2}));
  EXPECT_TRUE(file.warnings.empty());
}

TEST(Obj, BackslashJoinsLines) {
  const ObjFiles files;
  const ObjFile file =
      files.load("v 0 \\\n0 0\nv 1\\\r\n 0 0\nv 0 1 \\\r0\nv 1 1 0\nf \\\n 1 2\\\n 4 \\\n3\nusemtl a\\\nb\n");
  EXPECT_EQ(to_vector(file.mesh.positions), (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
  EXPECT_EQ(indices_of(file), (Indices{0, 1, 3, 0, 3, 2}));
  // A path at the end of a comment must not swallow the next line.
  EXPECT_EQ(files.load("# from C:\\meshes\\\nv 1 2 3\n").mesh.positions.size(), 1u);
  // A backslash at the very end joins nothing.
  EXPECT_EQ(files.load("v 1 2 3 \\").mesh.positions.size(), 1u);
  EXPECT_EQ(files.load("v 1 2 3\\").mesh.positions[0], (Vec3f{1, 2, 3}));
  for (const char* face : {"f 1 2 3\\", "f 1 2 3 \\", "f 1// 2// 3//\\", "f -3 -2 -1\\"})
    EXPECT_EQ(files.load(std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\n") + face).mesh.triangle_count(), 1u)
        << face;
  files.write("end.mtl", "newmtl a\nKd 1 0 0\nmap_Kd t.png\\");
  const ObjFile named = files.load("v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nmtllib end.mtl\\");
  ASSERT_EQ(named.textures.size(), 1u);
  EXPECT_EQ(files.without_directory(named.textures[0].path), "t.png");
}

TEST(Obj, NamesGroupsAndSmoothingChangeNothing) {
  const ObjFile file =
      ObjFiles().load("o first part\n" + kSquare + "g a b\ns 1\nf 1 2 3\ns off\no\ng\nf 1 3 4\n");
  EXPECT_EQ(file.mesh.triangle_count(), 2u);
  EXPECT_TRUE(file.warnings.empty());
}

// Other programs read these files; a warning says what is left out.
TEST(Obj, FacesThatNameWhatIsNotThereAreReadWithAWarning) {
  const ObjFiles files;
  const auto expect = [&](const std::string& text, const std::string& warning) {
    const ObjFile file = files.load(kSquare + text);
    EXPECT_EQ(files.as_text(file.warnings), std::vector<std::string>{warning}) << text;
    EXPECT_EQ(file.mesh.triangle_count(), 1u) << text;
    EXPECT_TRUE(file.mesh.normal_indices.empty() && file.mesh.uv_indices.empty()) << text;
  };
  expect("f 1//1 2//1 3//1\n", "mesh.obj:5:6: warning: 3 corners name a normal, but the file defines none");
  expect("f 1/7 2 3\n",
         "mesh.obj:5:5: warning: a corner names texture coordinates, but the file defines none");
  expect("f 1 2 3\nf 1 2\nf 1 # 2 3\nf\n",
         "mesh.obj:6:1: warning: 3 faces of fewer than 3 corners are skipped");
  expect("f 1 2 3\nf 1 \\\n2\n", "mesh.obj:6:1: warning: a face of fewer than 3 corners is skipped");
  // But what is there must be the right one.
  EXPECT_EQ(files.error(kSquare + "vn 0 0 1\nf 1//1 2//2 3//1\n"),
            "mesh.obj:6:11: normal index 2 is out of range: the file defines 1");
}

TEST(Obj, NormalsThatAreNotFiniteAreReported) {
  EXPECT_EQ(
      ObjFiles().warnings(kSquare + "vn 0 0 1\nvn nan nan nan\nvn 0 inf 0\nf 1//1 2//2 3//1\n"),
      std::vector<std::string>{"mesh.obj:6:1: warning: 2 normals are not finite: corners that have them "
                               "show the normal of their face"});
}

TEST(Obj, EachUnknownKeywordWarnsOnce) {
  EXPECT_EQ(ObjFiles().warnings(kSquare + "curv 0 1\nlod 1\n curv 2 3\nvp 1 2\nf 1 2 3\nfoo\nlod 2\n"),
            (std::vector<std::string>{"mesh.obj:5:1: warning: unknown keyword 'curv' is ignored",
                                      "mesh.obj:6:1: warning: unknown keyword 'lod' is ignored",
                                      "mesh.obj:8:1: warning: unknown keyword 'vp' is ignored",
                                      "mesh.obj:10:1: warning: unknown keyword 'foo' is ignored"}));
}

TEST(Obj, ManyUnknownKeywordsAreCutShort) {
  const ObjFiles files;
  std::string text = kSquare + "f 1 2 3\n";
  for (int i = 0; i < 100; ++i) text += "key" + std::to_string(i) + "\n";
  text += "l 1 2\n";
  for (const std::size_t chunk_bytes : {std::size_t{1}, std::size_t{100}, std::size_t{1} << 20}) {
    const ObjFile file = files.load(text, {.chunk_bytes = chunk_bytes});
    ASSERT_EQ(file.warnings.size(), 33u);
    EXPECT_EQ(files.without_directory(to_string(file.warnings.back())),
              "mesh.obj:38:1: warning: more unknown keywords are ignored");
  }
}

TEST(Obj, ReadsTheBraceForm) {
  const ObjFiles files;
  const std::string vertices = "vertices {\nv -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\n}\n";
  const ObjFile file = files.load(vertices + "triangles {\nf 1 3 4\nf 1 4 2\n}\n");
  EXPECT_EQ(file.mesh.positions.size(), 4u);
  EXPECT_EQ(indices_of(file), (Indices{0, 2, 3, 0, 3, 1}));
  EXPECT_TRUE(file.warnings.empty());
  EXPECT_EQ(files.load("  vertices{\nv 1 2 3\n  }\ntriangles\n{\n}\n").mesh.positions.size(), 1u);
}

TEST(Obj, FilesWithoutFacesAreEmptyMeshes) {
  const ObjFiles files;
  const std::vector<std::string> expected{"mesh.obj: warning: no faces"};
  for (const std::string text : {"", "\n", "# nothing\n"}) {
    const ObjFile file = files.load(text);
    EXPECT_EQ(file.mesh.triangle_count(), 0u);
    EXPECT_EQ(file.strokes.triangle_count(), 0u);
    EXPECT_EQ(files.as_text(file.warnings), expected) << text;
  }
}

TEST(Obj, KeepsDenormalAndTinyNumbers) {
  const ObjFile file = ObjFiles().load("v 1e-40 1e-60 -0.0\nvn 3.4028234e38 1e-999 -1e-45\n");
  EXPECT_EQ(file.mesh.positions[0].x, 1e-40f);
  EXPECT_EQ(file.mesh.positions[0].y, 0.0f);
  EXPECT_TRUE(std::signbit(file.mesh.positions[0].z));
  EXPECT_EQ(file.mesh.normals[0].x, std::numeric_limits<float>::max());
  EXPECT_EQ(file.mesh.normals[0].y, 0.0f);
  EXPECT_EQ(file.mesh.normals[0].z, -std::numeric_limits<float>::denorm_min());
}

TEST(Obj, KeepsDegenerateTriangles) {
  EXPECT_EQ(indices_of(ObjFiles().load(kSquare + "f 1 1 1\nf 1 2 1\n")), (Indices{0, 0, 0, 0, 1, 0}));
}

// The end of the text at the end of a page is where reading past it would show.
TEST(Obj, FilesMayEndAtAPageBoundary) {
  const ObjFiles files;
  for (const std::size_t size : {4095u, 4096u, 4097u, 8192u}) {
    const std::string end = "\nf 1 2 3";
    std::string text = kSquare + "#";
    text += std::string(size - text.size() - end.size(), 'x') + end;
    ASSERT_EQ(text.size(), size);
    EXPECT_EQ(indices_of(files.load(text)), (Indices{0, 1, 2}));
  }
}

}  // namespace
}  // namespace oktett::test::obj_test
