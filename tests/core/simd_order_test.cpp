#include "core/simd_order.h"

#include <gtest/gtest.h>

#include "core/simd_memory.h"

namespace oktett::simd_order_test {
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

TEST(SimdOrder, LanesAreWrittenLowestFirst) {
  float values[16], out[16];
  for (int i = 0; i < 16; ++i) values[i] = static_cast<float>(100 + i);
  for (unsigned set = 0; set < 0x10000; set += 7) {
    const int size = store_compact(set, Simd<float, 16, ScalarIsa>::load(values), out);
    int at = 0;
    for (int i = 0; i < 16; ++i) {
      if ((set >> i & 1) == 0) continue;
      ASSERT_EQ(out[at++], values[i]) << set;
    }
    ASSERT_EQ(size, at);
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

TEST(SimdGather, Words) {
  std::uint16_t base[101];
  for (int i = 0; i < 101; ++i) base[i] = static_cast<std::uint16_t>(0xffff - i * i);
  std::int32_t index[16], got[16];
  for (int i = 0; i < 16; ++i) index[i] = (i * 37 + 99) % 100;
  gather(base, Simd<std::int32_t, 16, ScalarIsa>::load(index)).store(got);
  for (int i = 0; i < 16; ++i) EXPECT_EQ(got[i], base[index[i]]);
}

TEST(SimdLookup, TakesNumbersFromRows) {
  float rows[2][16];
  std::uint16_t words[2][8];
  for (int i = 0; i < 16; ++i) rows[0][i] = static_cast<float>(i), rows[1][i] = static_cast<float>(100 + i);
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 2; ++j) words[j][i] = static_cast<std::uint16_t>(0x9e37 * (8 * j + i + 1));
  const PackedIndices<8, ScalarIsa> one(words[0]);
  const PackedIndexPair<ScalarIsa> two(words[0], words[1]);
  for (int k = 0; k < 3; ++k) {
    float got[16];
    one.look_up(k, rows[1]).store(got);
    for (int i = 0; i < 8; ++i) EXPECT_EQ(got[i], rows[1][words[0][i] >> 4 * k & 15]);
    two.look_up(k, rows[0], rows[1]).store(got);
    for (int i = 0; i < 16; ++i) EXPECT_EQ(got[i], rows[i / 8][words[i / 8][i % 8] >> 4 * k & 15]);
  }
}

TEST(SimdGather, DoublesOfFloats) {
  using D = Simd<double, 8, ScalarIsa>;
  float floats[50];
  for (int i = 0; i < 50; ++i) floats[i] = 0.1f * static_cast<float>(i);
  double index[8], got[8];
  for (int i = 0; i < 8; ++i) index[i] = (i * 31 + 49) % 50;
  gather(floats, D::load(index)).store(got);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(got[i], floats[static_cast<int>(index[i])]);
}

template <class T>
void expect_pairs(const T (&base)[51]) {
  using D = Simd<double, 8, ScalarIsa>;
  double index[8], first[8], second[8];
  for (int i = 0; i < 8; ++i) index[i] = (i * 31 + 49) % 50;
  D a, b;
  gather_pairs(base, D::load(index), a, b);
  a.store(first), b.store(second);
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(first[i], base[static_cast<int>(index[i])]);
    EXPECT_EQ(second[i], base[static_cast<int>(index[i]) + 1]);
  }
}

TEST(SimdGather, PairsOfFloatsAndWords) {
  float floats[51];
  std::uint16_t words[51];
  for (int i = 0; i < 51; ++i) {
    floats[i] = 0.1f * static_cast<float>(i);
    words[i] = static_cast<std::uint16_t>(65535 - 7 * i);
  }
  expect_pairs(floats), expect_pairs(words);
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
}  // namespace oktett::simd_order_test
