#include <gtest/gtest.h>

#include <string>

#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::verify_command_test {
namespace {

using test::CommandResult;
using test::contains;
using test::run_command;
using test::TempDir;

TEST(VerifyCommand, ChecksWhatItIsAskedFor) {
  const TempDir dir;
  const CommandResult torus = run_command(dir, {"verify", "--surface", "torus", "--rays", "20000"});
  EXPECT_EQ(torus.status, 0) << torus.out << torus.err;
  EXPECT_TRUE(contains(torus.out, "\ntorus ")) << torus.out;
  EXPECT_TRUE(contains(torus.out, "all is well"));
  EXPECT_FALSE(contains(torus.out, "random trees"));
  const CommandResult trees =
      run_command(dir, {"verify", "--json", "--surface", "combinations", "--rays", "2000"});
  EXPECT_EQ(trees.status, 0) << trees.out << trees.err;
  EXPECT_TRUE(contains(trees.out, "\"passed\": true")) << trees.out;
  EXPECT_TRUE(contains(trees.out, "\"wrong_spans\": 0"));
  const CommandResult changes = run_command(dir, {"verify", "--surface", "changes", "--rays", "20000"});
  EXPECT_EQ(changes.status, 0) << changes.out << changes.err;
  EXPECT_TRUE(contains(changes.out, "\nrandom sequences ")) << changes.out;
  const CommandResult scenes = run_command(dir, {"verify", "--surface", "trace_scene", "--rays", "20000"});
  EXPECT_EQ(scenes.status, 0) << scenes.out << scenes.err;
  EXPECT_TRUE(contains(scenes.out, "\nrandom scenes ")) << scenes.out;
}

TEST(VerifyCommand, MeshesBesideSurfacesAndAlone) {
  const TempDir dir;
  dir.write("tetrahedron.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const CommandResult both =
      run_command(dir, {"verify", "--surface", "torus", "--mesh", "tetrahedron.obj", "--rays", "2000"});
  EXPECT_EQ(both.status, 0) << both.out << both.err;
  EXPECT_TRUE(contains(both.out, "\ntorus ")) << both.out;
  EXPECT_TRUE(contains(both.out, "\ntetrahedron ")) << both.out;
  EXPECT_FALSE(contains(both.out, "kernel")) << both.out;
  const CommandResult alone =
      run_command(dir, {"verify", "--meshes-only", "--mesh", "tetrahedron.obj", "--rays", "2000"});
  EXPECT_EQ(alone.status, 0) << alone.out << alone.err;
  EXPECT_TRUE(contains(alone.out, "\ntetrahedron ")) << alone.out;
  for (const char* other : {"kernel", "surface ", "random trees", "torus"})
    EXPECT_FALSE(contains(alone.out, other)) << other << alone.out;
  const CommandResult made =
      run_command(dir, {"verify", "--meshes-only", "--rays", "100", "--isa", "scalar"});
  EXPECT_EQ(made.status, 0) << made.out << made.err;
  EXPECT_TRUE(contains(made.out, "closed")) << made.out;
}

/// Errors are reported before any work is done.
TEST(VerifyCommand, BadArgumentsAreErrors) {
  const TempDir dir;
  const auto error = [&](const std::vector<std::string>& arguments, int status = 2) {
    const CommandResult result = run_command(dir, arguments);
    EXPECT_EQ(result.status, status);
    EXPECT_EQ(result.out, "");
    return result.err;
  };
  EXPECT_TRUE(contains(error({"verify", "--surface", "torsu"}), "did you mean 'torus'"));
  EXPECT_TRUE(contains(error({"verify", "--surface", "qqqqqq"}), "expected one of"));
  EXPECT_TRUE(contains(error({"verify", "--mesh", "absent.obj"}, 1), "absent.obj"));
  EXPECT_TRUE(contains(error({"verify", "--surface", "torus", "--mesh", "absent.obj"}, 1), "absent.obj"));
  EXPECT_TRUE(contains(error({"verify", "--surface", "torus", "--meshes-only"}), "exclude each other"));
  EXPECT_TRUE(contains(error({"verify", "--isa", "mmx"}), "mmx"));
  EXPECT_TRUE(contains(error({"verify", "--bvh", "bast"}), "did you mean"));
}

/// A short run covers something and finds nothing.
TEST(VerifyCommand, GoesThroughEverythingForSomeTime) {
  const TempDir dir;
  const CommandResult run = run_command(dir, {"verify", "--hours", "0.0005", "--seed", "7", "--isa", "scalar",
                                              "--findings", dir.path().string()});
  EXPECT_EQ(run.status, 0) << run.out << run.err;
  EXPECT_TRUE(contains(run.out, "kernels x classes")) << run.out;
  EXPECT_TRUE(contains(run.out, "seed 7, instruction sets scalar: all is well")) << run.out;
  const CommandResult json = run_command(dir, {"verify", "--hours", "1e-5", "--json"});
  EXPECT_TRUE(contains(json.out, "\"passed\": true")) << json.out;
  EXPECT_TRUE(contains(json.out, "\"kernels\": {\"covered\": ")) << json.out;
}

/// A file that claims that a sphere of radius 1.001 is a certain box.
TEST(VerifyCommand, RunsFindingsAgain) {
  const TempDir dir;
  const std::string head =
      "# wrong: something\n# repeat: kernel disk far 5\n"
      "# ray: origin 0x0p+0 0x0p+0 0x1.4p+2 direction 0x0p+0 0x0p+0 -0x1p+0 tmin 0x0p+0 tmax inf\noktett: "
      "1\n";
  const std::string lie = dir.write("lie.yaml", head + "objects: [{sphere: {radius: 1.001}, name: box.7}]\n");
  const std::string truth = dir.write("truth.yaml", head + "objects: [{sphere: {radius: 1.001}}]\n");
  const CommandResult found = run_command(dir, {"verify", "--replay", lie});
  EXPECT_EQ(found.status, 3);
  EXPECT_TRUE(contains(found.out, "this scene: box.7 is hit at 3.999")) << found.out;
  const CommandResult nothing = run_command(dir, {"verify", "--replay", truth});
  EXPECT_EQ(nothing.status, 0) << nothing.out << nothing.err;
  EXPECT_TRUE(contains(nothing.out, "all is well; it was: something")) << nothing.out;
  const std::string scene = dir.write("scene.yaml", "oktett: 1\nobjects: []\n");
  const CommandResult bad = run_command(dir, {"verify", "--replay", scene});
  EXPECT_EQ(bad.status, 2);
  EXPECT_TRUE(contains(bad.err, "expected a finding of oktett verify")) << bad.err;
}

TEST(VerifyCommand, BadHoursAreErrors) {
  const TempDir dir;
  for (const char* hours : {"0", "-1", "x", "1h", "inf", "nan"}) {
    const CommandResult run = run_command(dir, {"verify", "--hours", hours});
    EXPECT_EQ(run.status, 2) << hours;
    EXPECT_TRUE(contains(run.err, "expected hours from 1e-06 to 1e+06")) << run.err;
  }
  EXPECT_EQ(run_command(dir, {"verify", "--hours", "1", "--quick"}).status, 2);
  EXPECT_EQ(run_command(dir, {"verify", "--hours", "1", "--replay", "x"}).status, 2);
  EXPECT_EQ(run_command(dir, {"verify", "--hours", "1", "--findings", "/nowhere/at/all"}).status, 1);
  EXPECT_EQ(run_command(dir, {"verify", "--replay", "absent.yaml"}).status, 1);
}

}  // namespace
}  // namespace oktett::verify_command_test
