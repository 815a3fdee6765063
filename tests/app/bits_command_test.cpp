/// \file PNG files of 16 bits, and depths in them.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::bits_command_test {
namespace {

using test::CommandResult;
using test::contains;
using test::run_command;
using test::TempDir;

/// Bits of a number and kind of colour of the PNG file that is written.
struct Written {
  int bits = 0, kind = 0;
  std::string file, err;
};

Written written(const std::vector<std::string>& options) {
  const TempDir dir;
  dir.write("a.yaml", test::kBall);
  std::vector<std::string> words{"render", "a.yaml", "-o", "x.png"};
  words.insert(words.end(), options.begin(), options.end());
  const CommandResult result = run_command(dir, words);
  EXPECT_EQ(result.status, 0) << result.err;
  Written w{0, 0, test::file_content(dir.file("x.png")), result.err};
  if (w.file.size() > 26) w.bits = w.file[24], w.kind = w.file[25];
  return w;
}

constexpr int kGrey = 0, kRgbAlpha = 6;

TEST(BitsCommand, WritesEightOrSixteenBits) {
  EXPECT_EQ(written({}).bits, 8);
  EXPECT_EQ(written({"--bits", "8"}).bits, 8);
  const Written sixteen = written({"--bits", "16"});
  EXPECT_EQ(sixteen.bits, 16);
  EXPECT_EQ(sixteen.kind, kRgbAlpha);
  // A picture of depths is grey in 8 bits, and holds lengths in 16.
  EXPECT_EQ(written({"--integrator", "depth"}).kind, kRgbAlpha);
}

TEST(BitsCommand, DepthsAreStepsOfAStatedUnit) {
  const Written depth = written({"--bits", "16", "--integrator", "depth"});
  EXPECT_EQ(depth.bits, 16);
  EXPECT_EQ(depth.kind, kGrey);
  EXPECT_TRUE(contains(depth.file, std::string("depthUnit\0000.0001", 16))) << depth.err;
  EXPECT_TRUE(contains(depth.err, "depth: steps of 0.0001 units of the scene, 0 where nothing is\n"));
  const Written given = written({"--bits", "16", "--integrator", "depth", "--depth-unit", "0.25", "--quiet"});
  EXPECT_TRUE(contains(given.file, std::string("depthUnit\0000.25", 14)));
  EXPECT_EQ(given.err, "");
}

TEST(BitsCommand, RefusesWhatCannotBe) {
  const TempDir dir;
  dir.write("a.yaml", test::kBall);
  const auto refused = [&](const std::vector<std::string>& options) {
    std::vector<std::string> words{"render", "a.yaml"};
    words.insert(words.end(), options.begin(), options.end());
    const CommandResult result = run_command(dir, words);
    EXPECT_EQ(result.status, 2);
    return result.err;
  };
  EXPECT_EQ(refused({"--bits", "16", "-o", "x.exr"}),
            "oktett: --bits 16 is for PNG files; expected -o FILE.png\n");
  EXPECT_TRUE(contains(refused({"--bits", "12", "-o", "x.png"}), "expected 8 or 16"));
  EXPECT_TRUE(contains(refused({"--depth-unit", "1", "-o", "x.png"}), "--depth-unit is for"));
  EXPECT_TRUE(
      contains(refused({"--depth-unit", "-1", "--bits", "16", "--integrator", "depth", "-o", "x.png"}),
               "out of range"));
}

}  // namespace
}  // namespace oktett::bits_command_test
