#include "core/lanes.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

namespace oktett::quotients_test {
namespace {

/// The quotient of doubles, rounded to float, is the same number in all lanes; also where it lies at or next
/// to the middle between two floats, where numbers are subnormal, infinite or NaN, and where an inverse would
/// overflow.
TEST(Quotients, AreThoseOfDoublesRoundedToFloat) {
  using F = Simd<float, 8, ScalarIsa>;
  using D = Simd<double, 8, ScalarIsa>;
  std::mt19937_64 random(1);
  const double odd[] = {0,      -0.0,  1e-320, -1e-320,  1e-310,    1e300, 1.7e308,  1e-45,
                        1e-300, 3e-39, 1e39,   HUGE_VAL, -HUGE_VAL, NAN,   0x1p-149, 0x1p-1074};
  for (int n = 0; n < 40000; ++n) {
    const auto real = [&] {
      return std::ldexp(1.0 + static_cast<double>(random() >> 12) * 0x1p-52,
                        static_cast<int>(random() % 80) - 40);
    };
    double v[3][8], size[8];
    // The size is common, as one lane in doubt decides for all.
    for (int k = 0; k < 8; ++k) size[k] = n % 3 == 0 ? odd[random() % 16] : real();
    const int kind = n % 4;
    for (auto& column : v)
      for (int k = 0; k < 8; ++k) {
        column[k] = kind == 0 ? odd[random() % 16] : real();
        if (kind < 2) continue;
        // A middle between floats, times the size, moved by a few units.
        const auto a = static_cast<float>(column[k]), b = std::nextafter(a, HUGE_VALF);
        const double middle = (static_cast<double>(a) + static_cast<double>(b)) / 2;
        column[k] = middle * size[k];
        for (int step = static_cast<int>(random() % 7) - 3; step != 0; step += step < 0 ? 1 : -1)
          column[k] = std::nextafter(column[k], step < 0 ? -HUGE_VAL : HUGE_VAL);
        if (random() % 2 == 0) column[k] = -column[k];
      }
    const Vec3<F> got = float_quotients(Vec3<D>{D::load(v[0]), D::load(v[1]), D::load(v[2])}, D::load(size));
    const F* lanes[] = {&got.x, &got.y, &got.z};
    for (int axis = 0; axis < 3; ++axis) {
      float q[8];
      lanes[axis]->store(q);
      for (int k = 0; k < 8; ++k) {
        const auto want = static_cast<float>(v[axis][k] / size[k]);
        if (want != want) {
          EXPECT_TRUE(q[k] != q[k]);
        } else {
          ASSERT_EQ(std::bit_cast<std::uint32_t>(q[k]), std::bit_cast<std::uint32_t>(want))
              << v[axis][k] << " / " << size[k];
        }
      }
    }
  }
}

}  // namespace
}  // namespace oktett::quotients_test
