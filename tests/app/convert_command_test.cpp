// oktett convert: what it prints and returns.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::convert_command_test {
namespace {

using test::CommandResult;
using test::contains;
using test::file_content;
using test::run_command;
using test::TempDir;

constexpr const char* kMesh = "o thing\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

TEST(ConvertCommand, SaysWhatItWroteAndWhatIsLost) {
  const TempDir dir;
  dir.write("a.obj", kMesh);
  const CommandResult result = run_command(dir, {"convert", "a.obj", "b.stl", "--ascii"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out, "wrote b.stl: 2 triangles, 4 vertices\n");
  EXPECT_EQ(result.err,
            "b.stl: lost: 1 name of objects and groups\n"
            "b.stl: changed: polygons are cut into triangles (1 faces, 2 triangles)\n"
            "b.stl: lost: which triangles share vertices; read it with --weld to join them again\n");
  EXPECT_TRUE(file_content(dir.file("b.stl")).starts_with("solid oktett\nfacet normal 0 0 1\n"));
  const CommandResult quiet = run_command(dir, {"convert", "b.stl", "c.ply", "--weld", "--quiet"});
  EXPECT_EQ(quiet.status, 0);
  EXPECT_EQ(quiet.out + quiet.err, "");
  EXPECT_TRUE(contains(file_content(dir.file("c.ply")), "element vertex 4\n"));
}

TEST(ConvertCommand, WrongWordsAndFilesAreOneLine) {
  const TempDir dir;
  dir.write("a.obj", kMesh);
  const auto expect = [&](const std::string& from, const std::string& to, int status,
                          const std::string& line) {
    const CommandResult result = run_command(dir, {"convert", from, to});
    EXPECT_EQ(result.status, status) << to;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err, line);
  };
  expect("a.obj", "b.dae", 2,
         "b.dae: unknown kind of mesh file to write; expected .obj, .ply, .stl or .glb\n");
  expect("a.obj", "no/b.ply", 1, "no/b.ply: cannot write: no directory 'no'\n");
  expect("no.obj", "b.ply", 1, "no.obj: cannot read: No such file or directory\n");
  expect("a.obj", "./a.obj", 2, "./a.obj: is the input, too\n");
  EXPECT_EQ(test::file_count(dir), 1u);
}

TEST(ConvertCommand, ScenesOfPovRayBecomeSceneFiles) {
  const TempDir dir;
  dir.write("a.pov",
            "#version 3.7;\nglobal_settings { assumed_gamma 1 }\ncamera { location -5*z right x up y }\n"
            "background { rgb <0, 0, 1> }\nmesh { triangle { -x, x, y } pigment { rgb Shade } finish { "
            "ambient 1 diffuse 0 } }\n");
  const CommandResult result = run_command(dir, {"convert", "a.pov", "b.yaml", "-D", "Shade=0.5"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "wrote b-mesh.ply\nwrote b.yaml\n");
  EXPECT_TRUE(contains(file_content(dir.file("b.yaml")), "color: [0.5, 0.5, 0.5]"));
  for (const auto& [scene, picture] : {std::pair{"a.pov", "a.png"}, {"b.yaml", "b.png"}}) {
    std::vector<std::string> words{"render", scene, "-o", picture, "--size", "16x16", "--quiet"};
    if (std::string(scene) == "a.pov") words.insert(words.end(), {"-D", "Shade=0.5"});
    EXPECT_EQ(run_command(dir, words).status, 0) << scene;
  }
  const auto pixels = [&](const char* name) {
    const std::string bytes = file_content(dir.file(name));
    return bytes.substr(bytes.find("IDAT"));
  };
  EXPECT_EQ(pixels("a.png"), pixels("b.png"));
  EXPECT_EQ(run_command(dir, {"convert", "a.pov", "b.obj", "-D", "Shade=1"}).out,
            "wrote b.obj: 1 triangles, 3 vertices\n");
}

TEST(ConvertCommand, ScenesBecomeOneMesh) {
  const TempDir dir;
  dir.write("a.yaml", std::string(test::kBall) + "  - plane:\n");
  const CommandResult result = run_command(dir, {"convert", "a.yaml", "b.stl", "--resolution", "8"});
  EXPECT_EQ(result.status, 0);
  EXPECT_TRUE(result.out.starts_with("wrote b.stl: ")) << result.out;
  EXPECT_TRUE(contains(result.err, "a.yaml:7:5: warning: the plane has no end and is left out\n"))
      << result.err;
  const auto expect = [&](std::vector<std::string> words, const std::string& line) {
    words.insert(words.begin(), "convert");
    const CommandResult wrong = run_command(dir, words);
    EXPECT_EQ(wrong.status, 2) << line;
    EXPECT_TRUE(contains(wrong.err, line)) << wrong.err;
  };
  expect({"a.yaml", "c.ply", "--resolution", "0"},
         "--resolution: '0' is out of range; expected cells from 1 to 8192");
  expect({"a.yaml", "c.ply", "--resolution", "9", "--tolerance", "1"}, "exclude each other");
  expect({"a.yaml", "c.ply", "--select", "x"}, "no object is named 'x'");
  dir.write("a.obj", kMesh);
  expect({"a.obj", "c.ply", "--tolerance", "1"}, "a.obj: --tolerance is for a mesh of a scene");
  EXPECT_FALSE(std::filesystem::exists(dir.file("c.ply")));
}

}  // namespace
}  // namespace oktett::convert_command_test
