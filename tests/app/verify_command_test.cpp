#include <gtest/gtest.h>

#include <string>

#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett {
namespace {

using test::CommandResult;
using test::run_command;
using test::TempDir;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

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

}  // namespace
}  // namespace oktett
