#include "core/error.h"

#include <gtest/gtest.h>

namespace oktett::error_test {
namespace {

TEST(Location, LeavesOutWhatIsUnknown) {
  EXPECT_EQ(to_string(Location{"a.obj", 3, 7}), "a.obj:3:7");
  EXPECT_EQ(to_string(Location{"a.obj", 3, 0}), "a.obj:3");
  EXPECT_EQ(to_string(Location{"a.obj", 0, 0}), "a.obj");
}

TEST(Error, MessageBeginsWithThePlace) {
  const Error e(Location{"a.obj", 3, 7}, "bad index", ErrorKind::io);
  EXPECT_STREQ(e.what(), "a.obj:3:7: bad index");
  EXPECT_EQ(e.kind(), ErrorKind::io);
  EXPECT_EQ(e.where().line, 3);
  EXPECT_STREQ(Error("plain").what(), "plain");
  EXPECT_EQ(Error("plain").kind(), ErrorKind::bad_input);
}

TEST(Warning, SaysThatItIsOne) {
  const Location where{"a.obj", 2, 0};
  EXPECT_EQ(to_string(Warning{where, "no normals"}), "a.obj:2: warning: no normals");
}

TEST(NearestName, FindsSlipsOnly) {
  const char* const known[] = {"sphere", "plane", "polygon"};
  EXPECT_EQ(nearest_name("shpere", known, 3), "sphere");
  EXPECT_EQ(nearest_name("plan", known, 3), "plane");
  EXPECT_EQ(nearest_name("teapot", known, 3), "");
  EXPECT_EQ(nearest_name("x", known, 0), "");
}

}  // namespace
}  // namespace oktett::error_test
