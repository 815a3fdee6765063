#include "core/simd_order.h"

#include <gtest/gtest.h>

#include "core/simd_gather.h"

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

}  // namespace
}  // namespace oktett
