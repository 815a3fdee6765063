#include "render/transport/render_code.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "verify/cases/kernel_cases.h"

namespace oktett::view_directions_test {
namespace {

bool same(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) || (a != a && b != b);
}

TEST(ViewRays, AreUnitVectorsToThePointsForAnyNumberOfThem) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
  const double odd[] = {0, -0.0, nan, inf, -inf, 1e300, 1e-320};
  const ViewPlane plane{{-1.5, 1, -2}, {0.01, 0, 0.001}, {0, -0.01, 0}};
  CaseRandom r(1);
  for (const Isa isa : available_isas()) {
    for (const std::size_t count : {0u, 1u, 7u, 8u, 9u, 15u, 16u, 17u, 100u}) {
      std::vector<double> x(count), y(count);
      for (std::size_t i = 0; i < count; ++i) {
        const bool strange = i % 5 == 3;
        x[i] = strange ? odd[r.bits() % 7] : static_cast<double>(r.bits() % 100000) / 300;
        y[i] = strange ? odd[r.bits() % 7] : static_cast<double>(r.bits() % 100000) / 400;
      }
      std::vector<float> d[3];
      for (auto& column : d) column.assign(count + 1, 77);
      render_code(isa).view_directions(plane,
                                       {x.data(), y.data(), count, {d[0].data(), d[1].data(), d[2].data()}});
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3f expected(normalize(plane.corner + plane.per_pixel_x * x[i] + plane.per_pixel_y * y[i]));
        for (int k = 0; k < 3; ++k) ASSERT_TRUE(same(d[k][i], expected[k])) << i << " of " << count;
      }
      for (int k = 0; k < 3; ++k) ASSERT_EQ(d[k][count], 77) << "written past the end";
    }
  }
}

}  // namespace
}  // namespace oktett::view_directions_test
