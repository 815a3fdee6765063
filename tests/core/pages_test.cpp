#include "core/pages.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <new>

#include "core/soa.h"

namespace oktett {
namespace {

constexpr std::size_t kLargePage = std::size_t{2} << 20;

TEST(Pages, ReadAsZeroAndMayBeGivenBackInPieces) {
  for (const std::size_t bytes : {std::size_t{1}, std::size_t{4096}, kLargePiece - 1, kLargePiece,
                                  kLargePiece + 1, 3 * kLargePage + 12345}) {
    char* const p = static_cast<char*>(reserve_pages(bytes));
    EXPECT_EQ(p[0], 0);
    p[bytes - 1] = 7;
    EXPECT_EQ(p[bytes / 2], bytes / 2 == bytes - 1 ? 7 : 0);
    if (bytes > kLargePage) {
      release_pages(p + kLargePage, bytes - kLargePage);
      p[kLargePage - 1] = 5;
      EXPECT_EQ(p[kLargePage - 1], 5);
    }
    release_pages(p, bytes < kLargePage ? bytes : kLargePage);
  }
}

// The system has large pages only where they begin at multiples of their size.
TEST(Pages, LargePiecesBeginAtLargePages) {
  for (int i = 0; i < 8; ++i) {
    const std::size_t bytes = kLargePiece + static_cast<std::size_t>(i) * 4096;
    void* const p = reserve_pages(bytes);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(p) % kLargePage, 0u);
    release_pages(p, bytes);
  }
}

TEST(Pages, RefuseWhatIsNotThere) {
  EXPECT_TRUE(can_reserve(kLargePiece));
  EXPECT_FALSE(can_reserve(std::size_t{1} << 60));
  EXPECT_THROW(reserve_pages(std::size_t{1} << 60), std::bad_alloc);
  // What lies beside it must not overflow the sum.
  EXPECT_THROW(reserve_pages(~std::size_t{0} - 4095), std::bad_alloc);
}

// Columns move from the heap to pages of their own and back.
TEST(Pages, HoldLargeColumns) {
  const std::size_t large = kLargePiece / sizeof(std::uint32_t) + 5;
  Column<std::uint32_t> c;
  for (std::uint32_t i = 0; i < large; ++i) c.push_back(i);
  const Column<std::uint32_t> copy = c;
  c.resize_uninitialized(100);
  c.shrink_to_fit();
  EXPECT_LE(c.bytes(), 512u);
  for (std::uint32_t i = 0; i < 100; ++i) ASSERT_EQ(c[i], i);
  ASSERT_EQ(copy.size(), large);
  for (std::uint32_t i = 0; i < large; ++i) ASSERT_EQ(copy[i], i);
}

}  // namespace
}  // namespace oktett
