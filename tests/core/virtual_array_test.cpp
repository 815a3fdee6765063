#include "core/pages.h"

#include <gtest/gtest.h>

namespace oktett::virtual_array_test {
namespace {

// Far more is reserved than is used, and only what is written costs memory.
TEST(VirtualArray, ReservesMoreThanThereIs) {
  VirtualArray<int> a(std::size_t{1} << 32);
  EXPECT_EQ(a[0], 0);
  a[12345] = 7;
  EXPECT_EQ(a[std::size_t{1} << 31], 0);
  EXPECT_EQ(a[12345], 7);
}

TEST(VirtualArray, MovesAndEmpties) {
  VirtualArray<int> a(10), empty, none(0);
  a[3] = 4;
  VirtualArray<int> b(std::move(a));
  EXPECT_EQ(a.data(), nullptr);
  EXPECT_EQ(b[3], 4);
  EXPECT_EQ(none.data(), nullptr);
  b = VirtualArray<int>(5);
  EXPECT_EQ(b[4], 0);
}

}  // namespace
}  // namespace oktett::virtual_array_test
