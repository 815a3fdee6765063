#include "core/rounding.h"

#include <gtest/gtest.h>

namespace oktett::rounding_test {
namespace {

TEST(Rounding, EveryComponentIsRounded) {
  for (int i = 1; i < 100; ++i) {
    const Vec3d v{0.1 * i, 0.2 * i + 0.01, 0.3 * i - 0.02}, r = rounded_to_floats(v);
    for (int k = 0; k < 3; ++k) {
      volatile float f = static_cast<float>(v[k]);
      const double expected = f;
      EXPECT_EQ(r[k], expected) << i << " " << k;
    }
  }
}

}  // namespace
}  // namespace oktett::rounding_test
