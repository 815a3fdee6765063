#include "core/pages.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <new>
#include <utility>
#include <vector>

#include "core/soa.h"

namespace oktett::pages_test {
namespace {

TEST(Pages, ReadAsZeroAndMayBeGivenBackInPieces) {
  for (const std::size_t bytes : {std::size_t{1}, std::size_t{4096}, kLargePiece - 1, kLargePiece,
                                  kLargePiece + 1, 3 * kHugePage + 12345}) {
    char* const p = static_cast<char*>(reserve_pages(bytes));
    EXPECT_EQ(p[0], 0);
    p[bytes - 1] = 7;
    EXPECT_EQ(p[bytes / 2], bytes / 2 == bytes - 1 ? 7 : 0);
    if (bytes > kHugePage) {
      release_pages(p + kHugePage, bytes - kHugePage);
      p[kHugePage - 1] = 5;
      EXPECT_EQ(p[kHugePage - 1], 5);
    }
    release_pages(p, bytes < kHugePage ? bytes : kHugePage);
  }
}

TEST(Pages, HugePagesBeginAtMultiplesOfTheirSize) {
  for (int i = 0; i < 8; ++i) {
    const std::size_t bytes = kLargePiece + static_cast<std::size_t>(i) * page_size();
    void* const p = reserve_pages(bytes);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(p) % kHugePage, 0u);
    release_pages(p, bytes);
  }
}

TEST(Pages, HugeOnesAreAtLeastHalfFull) {
  constexpr std::size_t kHalf = kHugePage / 2, kAll = ~std::size_t{0};
  for (const auto& [bytes, whole] :
       std::vector<std::pair<std::size_t, std::size_t>>{{0, 0},
                                                        {1, 4096},
                                                        {4096, 4096},
                                                        {4097, 8192},
                                                        {kHalf - 1, kHalf},
                                                        {kHalf, kHugePage},
                                                        {kHugePage, kHugePage},
                                                        {kHugePage + 1, kHugePage + 4096},
                                                        {3 * kHugePage + kHalf, 4 * kHugePage},
                                                        {kAll - 1, kAll - 1},
                                                        {kAll, kAll}})
    EXPECT_EQ(whole_pages(bytes, 4096), whole) << bytes;
  EXPECT_EQ(whole_pages(1, 65536), 65536u);
  EXPECT_EQ(whole_pages(kHugePage + 65537, 65536), kHugePage + 131072);
  EXPECT_EQ(whole_pages(1), page_size());
}

TEST(Pages, AreThoseOfTheSystem) { EXPECT_EQ(page_size(), static_cast<std::size_t>(sysconf(_SC_PAGESIZE))); }

// What is given back must not reach beyond the range, whatever the size of pages: the kernel rounds lengths
// up, and would zero what lies behind. With pages of 64 KiB taken for 4 KiB, the last assertion fails.
TEST(Pages, OfARangeDoNotReachBeyondIt) {
  for (const std::size_t page : {std::size_t{4096}, std::size_t{16384}, std::size_t{65536}})
    for (std::uintptr_t begin = 10 * page - 8192; begin <= 11 * page; begin += 1024)
      for (const std::size_t bytes :
           {std::size_t{0}, std::size_t{1}, page - 1, page, page + 4096, 3 * page + 4096}) {
        const PageRange within = pages_within(begin, bytes, page), around = pages_around(begin, bytes, page);
        for (const PageRange& range : {within, around}) {
          ASSERT_EQ(range.first % page, 0u);
          ASSERT_EQ(range.bytes % page, 0u);
        }
        if (within.bytes > 0) {
          ASSERT_GE(within.first, begin);
          ASSERT_LE(within.first + within.bytes, begin + bytes);
        }
        // No whole page is left out: on each side less than one remains.
        ASSERT_GT(within.bytes + 2 * page, bytes);
        if (bytes > 0) {
          ASSERT_LE(around.first, begin);
          ASSERT_GE(around.first + around.bytes, begin + bytes);
          ASSERT_LT(around.bytes, bytes + 2 * page);
        }
      }
}

TEST(Pages, LoseWhatIsDiscarded) {
  const std::size_t kPage = page_size();
  constexpr std::size_t kCount = 8;
  char* const p = static_cast<char*>(reserve_pages(kCount * kPage));
  for (std::size_t i = 0; i < kCount * kPage; ++i) p[i] = 1;
  discard_pages(p, 0);
  discard_pages(p + 100, kPage);
  // Whole pages are 3 to 5.
  discard_pages(p + 2 * kPage + 1, 4 * kPage);
  for (std::size_t i = 0; i < kCount * kPage; ++i)
    ASSERT_EQ(p[i], 3 * kPage <= i && i < 6 * kPage ? 0 : 1) << i;
  p[4 * kPage] = 2;
  EXPECT_EQ(p[4 * kPage], 2);
  release_pages(p, kCount * kPage);
}

TEST(Pages, RefuseWhatIsNotThere) {
  EXPECT_TRUE(can_reserve(kLargePiece));
  EXPECT_FALSE(can_reserve(std::size_t{1} << 60));
  EXPECT_THROW(reserve_pages(std::size_t{1} << 60), std::bad_alloc);
  // What lies beside it must not overflow the sum.
  EXPECT_THROW(reserve_pages(~std::size_t{0} - 4095), std::bad_alloc);
}

/// Which of `count` pages from `begin` on are in memory.
std::vector<bool> resident(char* begin, std::size_t count) {
  std::vector<unsigned char> pages(count);
  EXPECT_EQ(mincore(begin, count * page_size(), pages.data()), 0);
  std::vector<bool> in;
  for (const unsigned char page : pages) in.push_back((page & 1) != 0);
  return in;
}

TEST(Pages, ArePopulatedWhereAskedFor) {
  const std::size_t kPage = page_size();
  constexpr std::size_t kCount = 12;
  char* const p = static_cast<char*>(reserve_pages(kCount * kPage));
  p[0] = 3;
  p[5 * kPage + 7] = 4;
  populate_pages(p, 0);
  // From the middle of page 4 to the first byte of page 8.
  populate_pages(p + 4 * kPage + 100, 4 * kPage - 99);
  EXPECT_EQ(p[5 * kPage + 7], 4);
  const std::vector<bool> in = resident(p, kCount);
  // Systems that cannot populate pages leave those alone that have not been written.
  const bool can = in[4];
  for (std::size_t k = 0; k < kCount; ++k)
    EXPECT_EQ(in[k], k == 0 || k == 5 || (can && 4 <= k && k <= 8)) << "page " << k;
#ifdef MADV_POPULATE_WRITE
  // An emulator may say that it does so and do nothing.
  const bool says = madvise(p + kPage, kPage, MADV_POPULATE_WRITE) == 0;
  EXPECT_EQ(can, says && resident(p + kPage, 1)[0]);
#endif
  release_pages(p, kCount * kPage);
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
}  // namespace oktett::pages_test
