#include "core/soa.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace oktett::soa_test {
namespace {

// Every column starts on a cache line and may be read to the end of its last one.
TEST(Column, IsAlignedAndPadded) {
  for (std::size_t n = 1; n < 70; ++n) {
    const Column<float> c(n, 1.0f);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(c.data()) % kAlignment, 0u);
    EXPECT_EQ(c.bytes() % kAlignment, 0u);
    EXPECT_GE(c.bytes(), n * sizeof(float));
  }
}

TEST(Column, GrowsAndKeepsWhatItHolds) {
  Column<int> c;
  EXPECT_TRUE(c.empty());
  for (int i = 0; i < 1000; ++i) c.push_back(i);
  ASSERT_EQ(c.size(), 1000u);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(c[static_cast<std::size_t>(i)], i);
  c.resize_uninitialized(10);
  c.shrink_to_fit();
  EXPECT_LE(c.bytes(), 64u);
  EXPECT_EQ(c.back(), 9);
}

// The argument may be an element of the column itself.
TEST(Column, PushesItsOwnElement) {
  Column<int> c;
  c.push_back(7);
  for (int i = 0; i < 100; ++i) c.push_back(c[0]);
  for (int x : c) EXPECT_EQ(x, 7);
}

TEST(Column, CopiesAndMoves) {
  Column<double> a(5, 2.5);
  Column<double> b(a);
  a[0] = 1;
  EXPECT_EQ(b[0], 2.5);
  const Column<double> c(std::move(b));
  EXPECT_EQ(c.size(), 5u);
  const Column<double>& self = a;
  a = self;
  EXPECT_EQ(a[0], 1);
  a.clear();
  EXPECT_EQ(a.bytes(), 0u);
  EXPECT_EQ(Column<double>(a).size(), 0u);
}

}  // namespace
}  // namespace oktett::soa_test
