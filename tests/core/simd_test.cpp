#include "core/simd.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/limits.h"

namespace oktett::simd_test {
namespace {

template <int W>
struct Width {
  static constexpr int value = W;
};

/// Tests of the semantics on the scalar instruction set. Vector registers are tested through the kernels.
template <class W>
class SimdTest : public testing::Test {
 protected:
  static constexpr int kWidth = W::value;
  using Floats = Simd<float, kWidth, ScalarIsa>;
  using Doubles = Simd<double, kWidth, ScalarIsa>;
  static Floats ramp(float first) {
    float v[kWidth];
    for (int i = 0; i < kWidth; ++i) v[i] = first + static_cast<float>(i);
    return Floats::load(v);
  }
  static float lane(const Floats& f, int i) {
    float v[kWidth];
    f.store(v);
    return v[i];
  }
  static double lane(const Doubles& d, int i) {
    double v[kWidth];
    d.store(v);
    return v[i];
  }
};
using Widths = testing::Types<Width<1>, Width<4>, Width<8>, Width<16>>;
TYPED_TEST_SUITE(SimdTest, Widths);

TYPED_TEST(SimdTest, ArithmeticIsLaneByLane) {
  using F = typename TestFixture::Floats;
  const F a = TestFixture::ramp(1.5f), b = TestFixture::ramp(-3.25f);
  for (int i = 0; i < TestFixture::kWidth; ++i) {
    const float x = 1.5f + static_cast<float>(i), y = -3.25f + static_cast<float>(i);
    EXPECT_EQ(TestFixture::lane(a + b, i), x + y);
    EXPECT_EQ(TestFixture::lane(a - b, i), x - y);
    EXPECT_EQ(TestFixture::lane(a * b, i), x * y);
    EXPECT_EQ(TestFixture::lane(b / a, i), y / x);
    EXPECT_EQ(TestFixture::lane(-a, i), -x);
    EXPECT_EQ(TestFixture::lane(abs(b), i), std::abs(y));
    EXPECT_EQ(TestFixture::lane(sqrt(a), i), std::sqrt(x));
  }
}

TYPED_TEST(SimdTest, LoadFrontRepeatsTheLastElement) {
  constexpr int width = TestFixture::kWidth;
  for (int count = 1; count <= width; ++count) {
    std::vector<float> values;
    for (int i = 0; i < count; ++i) values.push_back(2.0f * static_cast<float>(i) + 3);
    const auto front = TestFixture::Floats::load_front(values.data(), count);
    for (int i = 0; i < width; ++i)
      EXPECT_EQ(TestFixture::lane(front, i), values[static_cast<std::size_t>(std::min(i, count - 1))]);
  }
}

// The second operand survives a NaN on either side, so an accumulator there never takes one in.
TYPED_TEST(SimdTest, MinAndMaxReturnTheSecondOperandOnNan) {
  using F = typename TestFixture::Floats;
  EXPECT_EQ(TestFixture::lane(min(F(kNan), F(2.0f)), 0), 2.0f);
  EXPECT_EQ(TestFixture::lane(max(F(kNan), F(2.0f)), 0), 2.0f);
  EXPECT_TRUE(std::isnan(TestFixture::lane(min(F(2.0f), F(kNan)), 0)));
  EXPECT_TRUE(std::isnan(TestFixture::lane(max(F(2.0f), F(kNan)), 0)));
  EXPECT_FALSE(std::signbit(TestFixture::lane(min(F(-0.0f), F(0.0f)), 0)));
  EXPECT_TRUE(std::signbit(TestFixture::lane(max(F(0.0f), F(-0.0f)), 0)));
}

TYPED_TEST(SimdTest, ComparisonsAreFalseOnNan) {
  using F = typename TestFixture::Floats;
  const F n(kNan), one(1.0f);
  EXPECT_TRUE(none(n < one) && none(one < n) && none(n <= one) && none(one <= n) && none(n == n));
  EXPECT_TRUE(none(n > one) && none(n >= one));
  const unsigned all = (1u << TestFixture::kWidth) - 1;
  EXPECT_EQ(bits(one <= one), all);
  EXPECT_EQ(bits(one >= one), all);
  EXPECT_EQ(bits(~(n < one)), all);
}

TYPED_TEST(SimdTest, MasksMapToBitsAndBack) {
  using F = typename TestFixture::Floats;
  const unsigned all = (1u << TestFixture::kWidth) - 1;
  for (unsigned b = 0; b <= all; b = b * 3 + 1) {
    const auto m = F::M::from_bits(b);
    EXPECT_EQ(bits(m), b & all);
    EXPECT_EQ(bits(~m), ~b & all);
    EXPECT_EQ(bits(m & F::M::all_true()), b & all);
    EXPECT_EQ(bits(m | ~m), all);
    EXPECT_EQ(any(m), (b & all) != 0);
    EXPECT_EQ(bits(mask_cast<double>(m)), b & all);
    const F chosen = select(m, TestFixture::ramp(1), F(-1.0f));
    for (int i = 0; i < TestFixture::kWidth; ++i)
      EXPECT_EQ(TestFixture::lane(chosen, i), b >> i & 1 ? 1.0f + static_cast<float>(i) : -1.0f);
  }
}

TYPED_TEST(SimdTest, ConversionsAreExactOrRoundedToNearest) {
  using F = typename TestFixture::Floats;
  using D = typename TestFixture::Doubles;
  for (const float x : {0.0f, -0.0f, 1.1f, 3.4e38f, 1e-45f, kInf, -kInf}) {
    EXPECT_EQ(TestFixture::lane(to_double(F(x)), 0), static_cast<double>(x));
    EXPECT_EQ(std::signbit(TestFixture::lane(to_double(F(x)), 0)), std::signbit(x));
  }
  for (const double x : {1 + 0x1p-24, 1 + 0x1.8p-24, 1 + 3 * 0x1p-24, 1e-46, 3.5e38, -1e-40, 0.1})
    EXPECT_EQ(TestFixture::lane(to_float(D(x)), TestFixture::kWidth - 1), static_cast<float>(x));
}

TYPED_TEST(SimdTest, ProductErrorIsExact) {
  using D = typename TestFixture::Doubles;
  for (int i = 1; i < 200; ++i) {
    const double a = 1 + i * 0x1.23456789abcdep-7, b = -3.7 * i + 0x1.fp-40;
    const double p = a * b;
    EXPECT_EQ(TestFixture::lane(product_error(D(a), D(b), D(p)), 0), std::fma(a, b, -p));
  }
}

TYPED_TEST(SimdTest, HorizontalExtremesSeeEveryLane) {
  using F = typename TestFixture::Floats;
  const F r = TestFixture::ramp(-2);
  EXPECT_EQ(horizontal_min(r), -2.0f);
  EXPECT_EQ(horizontal_max(r), -2.0f + static_cast<float>(TestFixture::kWidth - 1));
}

}  // namespace
}  // namespace oktett::simd_test
