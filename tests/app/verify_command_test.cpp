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
  EXPECT_TRUE(contains(error({"verify", "--isa", "mmx"}), "mmx"));
  EXPECT_TRUE(contains(error({"verify", "--bvh", "bast"}), "did you mean"));
}

}  // namespace
}  // namespace oktett
