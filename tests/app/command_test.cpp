#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::command_test {
namespace {

using test::CommandResult;
using test::contains;
using test::run_command;
using test::TempDir;

using Words = std::vector<std::string>;

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

TEST(Command, HelpAndVersionEverywhere) {
  const TempDir dir;
  for (const Words& words : {Words{"--help"}, {"render", "--help"}, {"info", "--help"}}) {
    const CommandResult result = run_command(dir, words);
    EXPECT_EQ(result.status, 0);
    EXPECT_TRUE(contains(result.out, "Usage: oktett")) << result.out;
    EXPECT_EQ(result.err, "");
  }
  for (const Words& words : {Words{"--version"}, {"render", "--version"}, {"info", "--version"}}) {
    const CommandResult result = run_command(dir, words);
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.out.substr(0, 7), "oktett ");
  }
  EXPECT_TRUE(contains(run_command(dir, {"render", "--help"}).out, "--display-server"));
}

TEST(Command, UsageErrorsExitWith2AndNameWhatIsNear) {
  const TempDir dir;
  struct Case {
    Words words;
    const char* message;
  };
  const Case cases[] = {
      {{}, "oktett: "},
      {{"rendr"}, "unknown command 'rendr'; did you mean 'render'?"},
      {{"render"}, "scene is required"},
      {{"render", "a.yaml", "--sppp", "4"}, "unknown option '--sppp'; did you mean '--spp'?"},
      {{"render", "a.yaml", "--nthread=4"}, "did you mean '--nthreads'?"},
      {{"info", "a.yaml", "--jason"}, "did you mean '--json'?"},
      {{"render", "a.yaml", "b.yaml"}, "unexpected argument 'b.yaml'"},
      {{"render", "a.yaml", "--spp", "four"},
       "--spp: expected a whole number from 0 to 4294967295, found 'four'"},
      {{"render", "a.yaml", "--spp", "-1"},
       "--spp: expected a whole number from 0 to 4294967295, found '-1'"},
      {{"render", "a.yaml", "--seed", "-1"},
       "--seed: expected a whole number from 0 to 4294967295, found '-1'"},
      {{"render", "a.yaml", "--spp", "0"}, "--spp"},
      {{"render", "a.yaml", "--size", "12"}, "--size"},
      {{"render", "a.yaml", "--size", "0x10"}, "--size"},
      {{"render", "a.yaml", "--size", "1x1x1"}, "--size"},
      {{"render", "a.yaml", "--size", "99999x99999"}, "--size"},
      {{"render", "a.yaml", "--cropwindow", "0,1,1,0"}, "--cropwindow"},
      {{"render", "a.yaml", "--cropwindow", "0,1,0"}, "--cropwindow"},
      {{"render", "a.yaml", "--cropwindow", "0,1,0,nan"}, "--cropwindow"},
      {{"render", "a.yaml", "--integrator", "pth"}, "did you mean 'path'?"},
      {{"render", "a.yaml", "--isa", "avx3"}, "avx3"},
      {{"render", "a.yaml", "--isa", "scaler"}, "unknown instruction set 'scaler'; did you mean 'scalar'?"},
      {{"render", "a.yaml", "--bvh", "bset"}, "did you mean 'best'?"},
      {{"render", "a.yaml", "-o", "a.pgn"}, "unknown image format '.pgn'; did you mean '.png'?"},
      {{"manual", "rendr"}, "there is no command 'rendr'; did you mean 'render'?"},
      {{"render", "a.yaml", "--stats=xml"}, "--stats"},
      {{"render", "a.yaml", "-D", "novalue"}, "-D"},
      {{"render", "a.yaml", "-t", "-1"}, "--nthreads: expected a whole number"},
      {{"render", "a.yaml", "-t", "x"}, "--nthreads: expected a whole number"},
      {{"render", "a.yaml", "-t", "4097"}, "--nthreads: 4097 is out of range; expected 0 to 4096"},
      {{"view", "a.yaml", "-t", "66000", "--no-open"}, "--nthreads: 66000 is out of range"},
  };
  for (const Case& c : cases) {
    const CommandResult result = run_command(dir, c.words);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_TRUE(contains(result.err, c.message)) << c.message << "\n" << result.err;
    EXPECT_EQ(result.out, "");
  }
}

TEST(Command, AMissingFileIsAnInputOutputError) {
  const TempDir dir;
  for (const char* verb : {"render", "info"}) {
    const CommandResult result = run_command(dir, {verb, "missing.yaml"});
    EXPECT_EQ(result.status, 1) << result.err;
    EXPECT_EQ(result.err.substr(0, 12), "missing.yaml");
  }
}

// The first line says where and what, for editors; no picture is written.
TEST(Command, ABadSceneNamesThePlace) {
  const TempDir dir;
  dir.write("bad.yaml", "oktett: 1\nfilm: {width: 8}\nobjekts: []\n");
  for (const char* verb : {"render", "info"}) {
    const CommandResult result = run_command(dir, {verb, "bad.yaml"});
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(first_line(result.err).substr(0, 13), "bad.yaml:3:1:") << result.err;
    EXPECT_EQ(result.out, "");
  }
  EXPECT_FALSE(std::filesystem::exists(dir.file("bad.png")));
}

}  // namespace
}  // namespace oktett::command_test
