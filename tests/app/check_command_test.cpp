#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::check_command_test {
namespace {

using test::CommandResult;
using test::contains;
using test::run_command;
using test::TempDir;

TEST(CheckCommand, ExitStatusSaysWhetherSomethingIsWrong) {
  const TempDir dir;
  dir.write("good.yaml", test::kBall);
  dir.write("warned.yaml", std::string(test::kBall) + "materials: {gold: {}}\n");
  dir.write("wrong.yaml", std::string(test::kBall) + "  - spher: {}\n  - sphere: {radius: x}\n");
  const CommandResult good = run_command(dir, {"check", "good.yaml"});
  EXPECT_EQ(good.status, 0) << good.err;
  EXPECT_EQ(good.out + good.err, "");
  EXPECT_EQ(run_command(dir, {"check", "warned.yaml"}).status, 0);
  EXPECT_EQ(run_command(dir, {"check", "--strict", "warned.yaml"}).status, 2);
  const CommandResult wrong = run_command(dir, {"check", "good.yaml", "wrong.yaml"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_EQ(wrong.out,
            "wrong.yaml:7:5: unknown key 'spher' in an object; did you mean 'sphere'?\n"
            "wrong.yaml:8:22: expected a number, found 'x'\n");
  EXPECT_EQ(wrong.err, "oktett: wrong.yaml: 2 errors, 0 warnings\n");
  EXPECT_EQ(run_command(dir, {"check", "wrong.yaml", "missing.yaml"}).status, 1);
  EXPECT_EQ(run_command(dir, {"check", "missing.yaml", "wrong.yaml"}).status, 1);
  EXPECT_EQ(run_command(dir, {"check"}).status, 2);
}

/// What a file says may hold what a terminal would obey.
TEST(CheckCommand, ShowsControlCharactersAsText) {
  const TempDir dir;
  dir.write("said.pov",
            "#version 3.7;\n#warning concat(\"a\", chr(27), \"[2J\\tb\")\n#debug concat(\"c\", chr(155), "
            "chr(7), \"\\n\")\n"
            "#render \"d\\n\"\nlight_source { -9*z, 1 }\ncamera { location -5*z }\nsphere { 0, 1 pigment { "
            "rgb 1 } }\n");
  const CommandResult pov = run_command(dir, {"check", "said.pov"});
  EXPECT_EQ(pov.out, "said.pov:2:1: warning: a\\x1b[2J\tb\n");
  EXPECT_EQ(pov.err, "c\\x9b\\x07\nd\noktett: said.pov: 0 errors, 1 warning\n");
  const CommandResult quiet =
      run_command(dir, {"render", "--quiet", "--size", "8x8", "-o", "x.png", "said.pov"});
  EXPECT_EQ(quiet.err, "said.pov:2:1: warning: a\\x1b[2J\tb\n");
}

/// Rendering still ends at the first error.
TEST(CheckCommand, RenderTellsTheFirstErrorOnly) {
  const TempDir dir;
  dir.write("wrong.yaml", std::string(test::kBall) + "  - spher: {}\n  - sphere: {radius: x}\n");
  const CommandResult render = run_command(dir, {"render", "wrong.yaml"});
  EXPECT_EQ(render.status, 2);
  EXPECT_EQ(render.err, "wrong.yaml:7:5: unknown key 'spher' in an object; did you mean 'sphere'?\n");
}

TEST(CheckCommand, PrintsAHundredFindings) {
  const TempDir dir;
  std::string text = test::kBall;
  for (int i = 0; i < 130; ++i) text += "  - spher: {}\n";
  dir.write("wrong.yaml", text);
  const CommandResult result = run_command(dir, {"check", "wrong.yaml"});
  EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 101);
  EXPECT_TRUE(contains(result.out, "... and 30 more\n"));
  EXPECT_TRUE(contains(result.err, "130 errors")) << result.err;
}

/// The same list of keys after each of many findings would hide them.
TEST(CheckCommand, TellsWhatIsKnownOnce) {
  const TempDir dir;
  dir.write("wrong.yaml",
            std::string(test::kBall) +
                "  - qqqqq: {}\n  - wwwww: {}\n  - sphere: {zzzzz: 1}\n  - spher: {}\n  - spher: {}\n");
  const std::string out = run_command(dir, {"check", "wrong.yaml"}).out;
  EXPECT_TRUE(contains(out, "wrong.yaml:7:5: unknown key 'qqqqq' in an object; shapes are mesh,")) << out;
  EXPECT_TRUE(contains(out, "wrong.yaml:8:5: unknown key 'wwwww' in an object\n")) << out;
  EXPECT_TRUE(contains(out, "wrong.yaml:9:14: unknown key 'zzzzz' in sphere; known are ")) << out;
  EXPECT_TRUE(contains(out, "wrong.yaml:10:5: unknown key 'spher' in an object; did you mean 'sphere'?\n"))
      << out;
  EXPECT_TRUE(contains(out, "wrong.yaml:11:5: unknown key 'spher' in an object; did you mean 'sphere'?\n"))
      << out;
}

TEST(CheckCommand, DefinitionsAndTheRootFolder) {
  const TempDir dir;
  dir.write("scene.yaml", "oktett: 1\nobjects: [{sphere: {radius: \"${r}\"}}]\n");
  EXPECT_EQ(run_command(dir, {"check", "scene.yaml"}).status, 2);
  EXPECT_EQ(run_command(dir, {"check", "-D", "r=2", "scene.yaml"}).status, 0);
  dir.write("in/scene.yaml", "oktett: 1\nobjects: [{mesh: {file: ../mesh.obj}}]\n");
  dir.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(run_command(dir, {"check", "in/scene.yaml"}).status, 0);
  const CommandResult outside = run_command(dir, {"check", "--root", "in", "in/scene.yaml"});
  EXPECT_EQ(outside.status, 2);
  EXPECT_TRUE(contains(outside.out, "lies outside")) << outside.out;
}

}  // namespace
}  // namespace oktett::check_command_test
