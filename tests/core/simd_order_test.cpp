#include "core/simd_order.h"

#include <gtest/gtest.h>

#include "core/simd_gather.h"
#include "core/simd_words.h"

namespace oktett {
namespace {

TEST(SimdOrder, SetBitsAreWrittenLowestFirst) {
  for (unsigned set = 0; set < 0x10000; set += 7) {
    std::int32_t out[16];
    const int size = store_set_bits<ScalarIsa>(set, 1000, out);
    unsigned back = 0;
    for (int i = 0; i < size; ++i) {
      ASSERT_TRUE(i == 0 || out[i - 1] < out[i]);
      back |= 1u << (out[i] - 1000);
    }
    ASSERT_EQ(back, set);
  }
}

TEST(SimdGather, TakesWhatTheIndexNames) {
  float base[100];
  for (int i = 0; i < 100; ++i) base[i] = static_cast<float>(i * i);
  std::int32_t index[16];
  for (int i = 0; i < 16; ++i) index[i] = i * 37 % 100;
  float got[16];
  gather(base, Simd<std::int32_t, 16, ScalarIsa>::load(index)).store(got);
  for (int i = 0; i < 16; ++i) EXPECT_EQ(got[i], base[index[i]]);
}

TEST(SimdGather, DoublesOfFloatsAndWords) {
  using D = Simd<double, 8, ScalarIsa>;
  float floats[50];
  std::uint16_t words[51] = {};
  for (int i = 0; i < 50; ++i) {
    floats[i] = 0.1f * static_cast<float>(i);
    words[i] = static_cast<std::uint16_t>(65535 - 7 * i);
  }
  double index[8], got[8];
  for (int i = 0; i < 8; ++i) index[i] = (i * 31 + 49) % 50;
  gather(floats, D::load(index)).store(got);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(got[i], floats[static_cast<int>(index[i])]);
  gather(words, D::load(index)).store(got);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(got[i], words[static_cast<int>(index[i])]);
}

TEST(SimdWords, AreNumbersWithoutSign) {
  const std::uint16_t words[17] = {9, 0, 1, 255, 256, 32767, 32768, 65535, 7, 6, 5, 4, 3, 2, 1, 40000, 50000};
  float got[16];
  for (unsigned flip = 0; flip < 16; ++flip) {
    load_words<ScalarIsa>(words + 1, flip).store(got);
    for (unsigned i = 0; i < 16; ++i) EXPECT_EQ(got[i], static_cast<float>(words[(i ^ flip) + 1]));
  }
}

}  // namespace
}  // namespace oktett
