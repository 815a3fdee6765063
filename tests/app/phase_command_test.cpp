// What a terminal shows while files are read and trees are built.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/app/run_on_terminal.h"
#include "tests/support/temp_dir.h"

namespace oktett::phase_command_test {
namespace {

using test::contains;
using test::run_on_terminal;
using test::TempDir;
using test::TerminalResult;
using test::TerminalSetting;

/// Runs the command with a terminal as its standard error, and returns what it prints there; nothing if this
/// system has no terminals.
std::string on_terminal(const TempDir& directory, const std::vector<std::string>& arguments) {
  TerminalSetting setting;
  setting.out = false;
  const TerminalResult result = run_on_terminal(directory, arguments, setting);
  EXPECT_EQ(result.status, 0) << result.text;
  return result.text;
}

constexpr const char* kTetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

TEST(PhaseCommand, TerminalsShowReadingBuildingAndRendering) {
  const TempDir dir;
  dir.write("mesh.obj", kTetrahedron);
  const std::string text =
      on_terminal(dir, {"render", "mesh.obj", "--size", "8x8", "--spp", "1", "-o", "a.png"});
  if (text.empty()) GTEST_SKIP() << "there are no terminals here";
  const std::size_t reading = text.find("\rreading mesh.obj    0.0%"),
                    building = text.rfind("\rbuilding the tree"), rendering = text.find("100.0%  elapsed");
  ASSERT_NE(reading, std::string::npos) << text;
  ASSERT_NE(building, std::string::npos) << text;
  ASSERT_NE(rendering, std::string::npos) << text;
  EXPECT_LT(reading, building);
  EXPECT_LT(building, rendering);
  // The line is cleared before what stays.
  EXPECT_NE(text.find("\r\x1b[K", building), std::string::npos);
}

TEST(PhaseCommand, QuietOnesShowNothing) {
  const TempDir dir;
  dir.write("mesh.obj", kTetrahedron);
  EXPECT_EQ(on_terminal(dir, {"render", "mesh.obj", "--size", "8x8", "--spp", "1", "-o", "a.png", "--quiet"}),
            "");
}

/// Names of files do not move the cursor.
TEST(PhaseCommand, NamesAreShownWithoutControlCharacters) {
  const TempDir dir;
  dir.write("a\x1b[2Jx.obj", kTetrahedron);
  const std::string text = on_terminal(dir, {"convert", "a\x1b[2Jx.obj", "b.ply"});
  if (text.empty()) GTEST_SKIP() << "there are no terminals here";
  EXPECT_TRUE(contains(text, "reading a?[2Jx.obj")) << text;
  EXPECT_FALSE(contains(text, "\x1b[2J")) << text;
}

}  // namespace
}  // namespace oktett::phase_command_test
