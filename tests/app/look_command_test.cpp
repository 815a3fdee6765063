#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::look_command_test {
namespace {

using test::CommandResult;
using test::file_content;
using test::run_command;
using test::TempDir;

constexpr const char* kTetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// The same as PLY and STL.
constexpr const char* kPlyTetrahedron =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

std::string stl_tetrahedron() {
  std::string text = "solid\n";
  const char* const corners[] = {"0 0 0", "1 0 0", "0 1 0", "0 0 1"};
  for (const auto& face : {std::array{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int corner : face) text.append("vertex ").append(corners[corner]).append("\n");
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid\n";
}

/// The pixels of the picture, or the message on stderr if another status than 0 is expected.
std::string picture(const TempDir& dir, const std::vector<std::string>& options, int status = 0,
                    const char* mesh = "mesh.obj") {
  std::vector<std::string> words{"render", mesh, "--size", "32x18", "-o", "x.png", "--spp", "2"};
  words.insert(words.end(), options.begin(), options.end());
  const CommandResult result = run_command(dir, words);
  EXPECT_EQ(result.status, status) << result.err;
  if (status != 0) return result.err;
  // The metadata before the pixels hold the command.
  const std::string file = file_content(dir.file("x.png"));
  return file.substr(file.find("IDAT"));
}

TEST(LookCommand, ShowsMeshesAloneInEachLook) {
  const TempDir dir;
  dir.write("mesh.obj", kTetrahedron);
  const std::string usual = picture(dir, {});
  EXPECT_EQ(picture(dir, {"--look", "studio"}), usual);
  const std::string clay = picture(dir, {"--look", "clay"}), normals = picture(dir, {"--look", "normals"});
  EXPECT_NE(clay, usual);
  EXPECT_NE(normals, usual);
  EXPECT_NE(picture(dir, {"--look", "wire"}), normals);
  EXPECT_NE(picture(dir, {"--integrator", "whitted"}), usual);
  // The bits do not depend on the threads or the instruction set.
  EXPECT_EQ(picture(dir, {"-t", "1"}), usual);
  EXPECT_EQ(picture(dir, {"--isa", "scalar"}), usual);
}

TEST(LookCommand, TheFormatOfTheMeshChangesNothing) {
  const TempDir dir;
  dir.write("mesh.obj", kTetrahedron);
  dir.write("mesh.ply", kPlyTetrahedron);
  dir.write("mesh.stl", stl_tetrahedron());
  const std::string usual = picture(dir, {});
  EXPECT_EQ(picture(dir, {}, 0, "mesh.ply"), usual);
  EXPECT_EQ(picture(dir, {"--up", "y"}, 0, "mesh.stl"), usual);
}

TEST(LookCommand, UpIsZInStlAndInPlyByBlender) {
  const TempDir dir;
  const std::string ply = kPlyTetrahedron, stl = stl_tetrahedron();
  dir.write("mesh.ply", ply);
  dir.write("mesh.stl", stl);
  const std::string usual = picture(dir, {}, 0, "mesh.ply");
  const std::string standing = picture(dir, {"--up", "z"}, 0, "mesh.ply");
  EXPECT_NE(standing, usual);
  EXPECT_EQ(picture(dir, {}, 0, "mesh.stl"), standing);
  EXPECT_EQ(picture(dir, {"--up", "z"}, 0, "mesh.stl"), standing);
  for (const char* writer : {"comment Created in Blender version 4.3.2\n",
                             "comment Created by Blender 2.93.4 - www.blender.org, source file: ''\r\n"}) {
    const std::size_t place = ply.find("element vertex");
    dir.write("mesh.ply", ply.substr(0, place) + writer + ply.substr(place));
    EXPECT_EQ(picture(dir, {}, 0, "mesh.ply"), standing) << writer;
    EXPECT_EQ(picture(dir, {"--up", "y"}, 0, "mesh.ply"), usual) << writer;
  }
  // Not what other programs say, nor what stands elsewhere.
  for (const char* writer : {"comment VCGLIB generated\n", "obj_info Blender\n"}) {
    const std::size_t place = ply.find("element vertex");
    dir.write("mesh.ply", ply.substr(0, place) + writer + ply.substr(place));
    EXPECT_EQ(picture(dir, {}, 0, "mesh.ply"), usual) << writer;
  }
}

/// A box, lower than wide, whose faces are seen from inside.
constexpr const char* kRoom =
    "v 0 0 0\nv 9 0 0\nv 9 0 7\nv 0 0 7\nv 0 3 0\nv 9 3 0\nv 9 3 7\nv 0 3 7\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

TEST(LookCommand, UpIsAsAskedFor) {
  const TempDir dir;
  dir.write("mesh.obj", kTetrahedron);
  const std::string usual = picture(dir, {});
  EXPECT_EQ(picture(dir, {"--up", "y"}), usual);
  EXPECT_NE(picture(dir, {"--up", "z"}), usual);
  EXPECT_NE(picture(dir, {"--up=-y"}), usual);
  // Also without a look, and in a format that defines what is up.
  const std::vector<std::string> normals{"--integrator", "normal"};
  EXPECT_NE(picture(dir, {"--integrator", "normal", "--up", "x"}), picture(dir, normals));
  EXPECT_EQ(run_command(dir, {"convert", "mesh.obj", "mesh.glb", "--quiet"}).status, 0);
  EXPECT_EQ(picture(dir, {}, 0, "mesh.glb"), usual);
  EXPECT_EQ(picture(dir, {"--up", "z"}, 0, "mesh.glb"), picture(dir, {"--up", "z"}));
}

TEST(LookCommand, TheViewIsAsAskedFor) {
  const TempDir dir;
  dir.write("mesh.obj", kRoom);
  const std::string usual = picture(dir, {}), outside = picture(dir, {"--view", "outside"});
  EXPECT_EQ(picture(dir, {"--view", "auto"}), usual);
  EXPECT_EQ(picture(dir, {"--view", "inside"}), usual);
  EXPECT_NE(outside, usual);
  dir.write("mesh.obj", kTetrahedron);
  EXPECT_EQ(picture(dir, {"--view", "outside"}), picture(dir, {}));
  EXPECT_NE(picture(dir, {"--view", "inside"}), picture(dir, {}));
}

// The name of a material is the user's: none stands for "there is none".
TEST(LookCommand, MaterialsOfAnyNameAreKept) {
  const TempDir dir;
  const auto with_material = [&](const std::string& name) {
    dir.write("mesh.mtl", "newmtl " + name + "\nKd 1 0 0\n");
    dir.write("mesh.obj", "mtllib mesh.mtl\nusemtl " + name + "\n" + kTetrahedron);
    return picture(dir, {});
  };
  EXPECT_EQ(with_material("neutral"), with_material("red"));
}

TEST(LookCommand, WarnsOfMeshesThatCannotBeSeen) {
  const TempDir dir;
  dir.write("mesh.obj", "v 0 0 0\nv 1 2 3\nv 2 4 6\nf 1 2 3\nf 1 1 2\n");
  const std::vector<std::string> words{"render", "mesh.obj", "--size", "8x8", "--quiet", "--no-output"};
  const CommandResult result = run_command(dir, words);
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("mesh.obj: warning: no triangle of the mesh has an area"), std::string::npos)
      << result.err;
  dir.write("mesh.obj", std::string(kTetrahedron) + "f 1 1 2\n");
  EXPECT_EQ(run_command(dir, words).err, "");
}

TEST(LookCommand, RefusesWhatHasNoLook) {
  const TempDir dir;
  dir.write("mesh.obj", kTetrahedron);
  EXPECT_NE(picture(dir, {"--look", "clai"}, 2).find("did you mean 'clay'?"), std::string::npos);
  EXPECT_NE(picture(dir, {"--look", "clay", "--integrator", "ao"}, 2).find("--integrator"),
            std::string::npos);
  EXPECT_NE(picture(dir, {"--up", "w"}, 2).find("expected x, y, z, -x, -y or -z"), std::string::npos);
  EXPECT_NE(picture(dir, {"--view", "insde"}, 2).find("did you mean 'inside'?"), std::string::npos);
  EXPECT_NE(picture(dir, {"--view", "inside", "--integrator", "ao"}, 2).find("--integrator"),
            std::string::npos);
  dir.write("scene.yaml", "oktett: 1\nobjects: [{sphere: }]\n");
  for (const auto& [option, value] : {std::pair{"--look", "clay"}, {"--up", "z"}, {"--view", "inside"}}) {
    const CommandResult result = run_command(dir, {"render", "scene.yaml", option, value});
    EXPECT_EQ(result.status, 2);
    EXPECT_NE(result.err.find(std::string(option) + " is for meshes"), std::string::npos) << result.err;
  }
}

}  // namespace
}  // namespace oktett::look_command_test
