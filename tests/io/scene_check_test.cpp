// All that is wrong in a file at once.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "io/scene/check.h"
#include "tests/io/scene_test_support.h"

namespace oktett::scene_check_test {
namespace {

using test::SceneFiles;
using Lines = std::vector<std::string>;

/// The first line of each finding.
Lines check(const SceneFiles& files, const std::string& name, const Definitions& definitions = {}) {
  Lines lines;
  for (const SceneFinding& finding : check_file(files.dir.file(name), definitions).list)
    lines.push_back(files.without_directory(finding.text.substr(0, finding.text.find('\n'))));
  return lines;
}

/// `text` stands from line 2 on.
Lines check_v1(const std::string& text, const Definitions& definitions = {}) {
  SceneFiles files;
  files.dir.write("scene.yaml", "oktett: 1\n" + text);
  return check(files, "scene.yaml", definitions);
}

TEST(SceneCheck, NothingIsWrong) {
  EXPECT_EQ(check_v1("materials: {gold: {color: [1, 1, 0]}}\nobjects: [{sphere: {}, material: gold}]"),
            Lines{});
}

/// Values, keys, names and missing keys in all sections, in the order of the file.
TEST(SceneCheck, TellsAllErrorsInTheOrderOfTheFile) {
  EXPECT_EQ(
      check_v1("objects:\n"
               "  - {spher: {}, material: glod}\n"
               "  - sphere: {radius: x, center: [0, y, 0, 0], colour: 3}\n"
               "  - group: [{box: {min: [0, a, 0]}}, {torus: {major: -1}}]\n"
               "  - {sphere: {}, transform: [{scale: b}, {rotate: {axis: [0, 0, 0], angle: 1}}]}\n"
               "materials:\n"
               "  gold: {ior: 0, opacity: 2, map_color: none.png}\n"
               "lights:\n"
               "  - point: {positon: [0, 0, 0]}\n"
               "  - spot: {color: 3}\n"
               "camera: {fov: 200, projection: fish}\n"
               "film: {width: 0, height: 0}\n"),
      (Lines{
          "scene.yaml:3:6: unknown key 'spher' in an object; did you mean 'sphere'?",
          "scene.yaml:3:27: unknown material 'glod'; did you mean 'gold'?",
          "scene.yaml:4:22: expected a number, found 'x'",
          "scene.yaml:4:33: expected 3 numbers, found 4",
          "scene.yaml:4:47: unknown key 'colour' in sphere; known are center, radius",
          "scene.yaml:5:29: expected a number, found 'a'",
          "scene.yaml:5:54: expected a number of at least 0, found '-1'",
          "scene.yaml:6:38: expected a number, found 'b'",
          "scene.yaml:6:58: the axis of a rotation must not be zero",
          "scene.yaml:8:15: expected a number greater than 0, found '0'",
          "scene.yaml:8:27: expected a number from 0 to 1, found '2'",
          "scene.yaml:8:41: 'none.png': no such file",
          "scene.yaml:10:13: unknown key 'positon' in a point light; did you mean 'position'?",
          "scene.yaml:11:11: a spot light needs 'position'",
          "scene.yaml:11:19: expected a colour, [r, g, b] or \"#rrggbb\", found '3'",
          "scene.yaml:12:15: expected a number greater than 0 and less than 180, found '200'",
          "scene.yaml:12:32: expected perspective or orthographic or fisheye or ultra_wide_angle or "
          "omnimax or panoramic or cylindrical or spherical or mesh, found 'fish'; did you mean 'mesh'?",
          "scene.yaml:13:15: expected a whole number from 1 to 65536, found '0'",
          "scene.yaml:13:26: expected a whole number from 1 to 65536, found '0'",
      }));
}

/// What is defined wrongly is known by its name, and what follows from an error is no other error.
TEST(SceneCheck, LeavesOutWhatFollowsFromAnError) {
  EXPECT_EQ(check_v1("materials: {gold: {colour: 1}}\ndefine: {p: {sphere: {radius: x}}}\n"
                     "objects: [{sphere: {}, material: gold}, {instance: p}]"),
            (Lines{"scene.yaml:2:20: unknown key 'colour' in a material; did you mean 'color'?",
                   "scene.yaml:3:31: expected a number, found 'x'"}));
  EXPECT_EQ(check_v1("params: {r: [1]}\nobjects: [{sphere: {radius: \"${r}\"}}]"),
            (Lines{"scene.yaml:2:13: expected a number or text, found a list"}));
  // Names may have been defined in what could not be read.
  EXPECT_EQ(check_v1("include: [none.yaml]\nobjects: [{sphere: {radius: \"${r}\"}, material: gold}, "
                     "{instance: p}]"),
            (Lines{"scene.yaml:2:11: 'none.yaml': no such file"}));
  EXPECT_EQ(check_v1("materials: [gold]\nobjects: [{sphere: {}, material: gold}]"),
            (Lines{"scene.yaml:2:12: expected a map for materials, found a list"}));
  // Nothing would be left of the difference, and the edges would not be perpendicular.
  EXPECT_EQ(
      check_v1("objects: [{difference: [{sphere: {radius: x}}, {disk: {}}]}]\n"),
      (Lines{"scene.yaml:2:43: expected a number, found 'x'",
             "scene.yaml:2:48: a disk has no inside; only solids can be combined, others as 'surfaces'"}));
  EXPECT_EQ(check_v1("lights: [{rectangle: {corner: [0, 0, 0], u: [1, 0, x], v: [0, 1, 0]}}]"),
            (Lines{"scene.yaml:2:52: expected a number, found 'x'"}));
}

TEST(SceneCheck, AnAliasIsToldOfOnce) {
  EXPECT_EQ(check_v1("objects: [&a {sphere: {radius: x}}, *a, *a]"),
            (Lines{"scene.yaml:2:32: expected a number, found 'x'"}));
}

TEST(SceneCheck, IncludedFilesComeAfterTheFileItself) {
  SceneFiles files;
  files.dir.write("part.yaml", "oktett: 1\nmaterials: {gold: {ior: x}}\n");
  files.dir.write("scene.yaml",
                  "oktett: 1\ninclude: [part.yaml]\nfilm: {with: 3}\n"
                  "objects: [{sphere: {}, material: gold}, {sphere: {}, material: lead}]\n");
  EXPECT_EQ(
      check(files, "scene.yaml"),
      (Lines{"scene.yaml:3:8: unknown key 'with' in film; did you mean 'width'?",
             "scene.yaml:4:64: unknown material 'lead'", "part.yaml:2:25: expected a number, found 'x'"}));
}

TEST(SceneCheck, WarnsOfWhatNothingRefersTo) {
  EXPECT_EQ(check_v1("materials: {gold: {}, lead: {}}\nmedia: {fog: {}}\ndefine: {p: {sphere: {}}}\n"
                     "objects: [{sphere: {}, material: lead}]"),
            (Lines{"scene.yaml:2:13: warning: material 'gold' is not used",
                   "scene.yaml:3:9: warning: medium 'fog' is not used",
                   "scene.yaml:4:10: warning: prototype 'p' is not used"}));
}

TEST(SceneCheck, AllLinesOfAnObjFile) {
  SceneFiles files;
  files.dir.write("bad.obj", "v 0 0 0\nv 1 x 0\nv 0 1 0\nf 1 2 9\nf 1 2 -\nf 1 2 3\nf 0 1 2\n?\x01\n");
  const Lines expected{"bad.obj:2:5: ", "bad.obj:4:7: vertex index 9 is out of range",
                       "bad.obj:5:7: expected a corner", "bad.obj:7:3: vertex index 0",
                       "bad.obj:8:1: expected an OBJ keyword"};
  const auto expect = [&](const Lines& found) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) test::expect_starts(found[i], expected[i]);
  };
  expect(check(files, "bad.obj"));
  files.dir.write("scene.yaml", "oktett: 1\nobjects: [{mesh: {file: bad.obj}}, {mesh: {file: bad.obj}}]\n");
  expect(check(files, "scene.yaml"));
}

TEST(SceneCheck, MaterialFiles) {
  SceneFiles files;
  files.dir.write(
      "odd.mtl",
      "# none of these is read\nKdd 1\nnewmtl a\nKdd 1 0 0\nmap_Ns a.png\nnewmtl b\nKD 1 0 0\nKdd 1\n"
      "map_Foo x\n  # Bar\n");
  files.dir.write("odd.obj", "mtllib odd.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  files.dir.write("odd.yaml", "oktett: 1\nobjects: [{mesh: {file: odd.obj}}]\n");
  for (const char* name : {"odd.mtl", "odd.obj", "odd.yaml"}) {
    const Lines odd = check(files, name);
    ASSERT_EQ(odd.size(), 3u) << name;
    test::expect_starts(odd[0], "odd.mtl:4:1: warning: unknown statement 'Kdd'; did you mean 'kd'?");
    test::expect_starts(odd[1], "odd.mtl:5:1: warning: 'map_Ns' is not used");
    test::expect_starts(odd[2], "odd.mtl:9:1: warning: unknown statement 'map_Foo'");
  }
  files.dir.write("bad.mtl", "newmtl a\nKd 1 x\nNi -1\nmap_Kd none.png\n");
  const Lines found = check(files, "bad.mtl");
  ASSERT_EQ(found.size(), 3u);
  test::expect_starts(found[0], "bad.mtl:2:6: warning: expected a finite number");
  test::expect_starts(found[1], "bad.mtl:3:6: warning: Ni must be greater than 0");
  test::expect_starts(found[2], "bad.mtl:4:1: warning: texture none.png not used: no such file");
}

TEST(SceneCheck, EndsWhereTooMuchIsWrong) {
  SceneFiles files;
  std::string text = "oktett: 1\nobjects:\n";
  for (int i = 0; i < 1200; ++i) text += "  - spher: {}\n";
  files.dir.write("scene.yaml", text);
  const Findings findings = check_file(files.dir.file("scene.yaml"));
  EXPECT_TRUE(findings.has_more);
  EXPECT_EQ(findings.list.size(), 1000u);
  // The errors of one alias are left out, but each costs time.
  text = "oktett: 1\nobjects:\n  - &a {spher: {}}\n";
  for (int i = 0; i < 20000; ++i) text += "  - *a\n";
  files.dir.write("scene.yaml", text);
  EXPECT_TRUE(check_file(files.dir.file("scene.yaml")).has_more);
}

TEST(SceneCheck, AFileThatCannotBeRead) {
  SceneFiles files;
  const Findings findings = check_file(files.dir.file("none.yaml"));
  ASSERT_EQ(findings.list.size(), 1u);
  EXPECT_EQ(findings.list[0].kind, SceneFinding::Kind::io);
}

/// The examples are right.
TEST(SceneCheck, Examples) {
  const std::filesystem::path scenes = std::filesystem::path(OKTETT_SOURCE_DIR) / "scenes";
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(scenes)) {
    if (entry.path().extension() != ".yaml") continue;
    ++count;
    const std::string tetrahedron = (scenes / "assets" / "tetrahedron.obj").string();
    for (const SceneFinding& finding : check_file(entry.path().string(), {{"bunny", tetrahedron}}).list)
      EXPECT_EQ(finding.kind, SceneFinding::Kind::warning) << finding.text;
  }
  EXPECT_GT(count, 30);
}

}  // namespace
}  // namespace oktett::scene_check_test
