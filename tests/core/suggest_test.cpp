#include "core/error.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace oktett::suggest_test {
namespace {

const std::vector<std::string> kNames{"sphere", "plane", "torus"};

TEST(Suggest, NamesTheNearest) {
  EXPECT_EQ(did_you_mean("shpere", kNames), "; did you mean 'sphere'?");
  EXPECT_EQ(did_you_mean("shpere", kNames, "expected one"), "; did you mean 'sphere'?");
}

TEST(Suggest, SaysWhatIsExpectedIfNoneIsNear) {
  EXPECT_EQ(did_you_mean("teapot", kNames), "");
  EXPECT_EQ(did_you_mean("teapot", kNames, "expected one"), "; expected one");
  EXPECT_EQ(did_you_mean("teapot", {}, "expected one"), "; expected one");
}

TEST(Suggest, NamesNothingWithoutACommonLetter) {
  const std::vector<std::string> names{"uv", "e", "pi"};
  EXPECT_EQ(did_you_mean("t", names), "");
  EXPECT_EQ(did_you_mean("xy", names), "");
  EXPECT_EQ(did_you_mean("up", names), "; did you mean 'uv'?");
}

TEST(Suggest, ShowsNoControlCharacters) {
  EXPECT_EQ(did_you_mean("gold", std::vector<std::string>{"gold\x1b"}), "; did you mean 'gold?'?");
}

TEST(Suggest, LooksAtTenThousandNames) {
  std::vector<std::string> names(10000, "something else");
  names.emplace_back("gold");
  EXPECT_EQ(did_you_mean("glod", names), "");
  names[9999] = "gold";
  EXPECT_EQ(did_you_mean("glod", names), "; did you mean 'gold'?");
}

TEST(Suggest, EditDistanceCountsLetters) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("abc", ""), 3u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("glod", "gold"), 2u);
}

}  // namespace
}  // namespace oktett::suggest_test
