#include <gtest/gtest.h>

#include <string>

#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::embree_command_test {
namespace {

using test::CommandResult;
using test::run_command;
using test::TempDir;

TEST(EmbreeCommand, RunsProgramsWithItsLibraries) {
  const TempDir directory;
  const CommandResult listed = run_command(directory, {"embree"});
  if (listed.status != 0) {
    // Where Embree's headers are not installed, there are no such libraries.
    EXPECT_EQ(listed.status, 1);
    EXPECT_NE(listed.err.find("built where Embree's headers are found"), std::string::npos) << listed.err;
    return;
  }
  EXPECT_NE(listed.out.find("/oktett-embree/libembree"), std::string::npos) << listed.out;
  const CommandResult run =
      run_command(directory, {"embree", "--", "sh", "-c", "echo $LD_LIBRARY_PATH; exit 7"});
  EXPECT_EQ(run.status, 7);
  EXPECT_NE(run.out.find("/oktett-embree"), std::string::npos) << run.out;
  const CommandResult missing = run_command(directory, {"embree", "--", "no-such-program"});
  EXPECT_EQ(missing.status, 1);
  EXPECT_NE(missing.err.find("cannot run 'no-such-program'"), std::string::npos) << missing.err;
}

}  // namespace
}  // namespace oktett::embree_command_test
