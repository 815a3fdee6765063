#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "verify/cases/kernel_cases.h"
#include "verify/oracles/known_shapes.h"

namespace oktett::root_finders_test {
namespace {

std::size_t kind_named(const std::string& name) {
  const std::vector<std::string>& kinds = known_kinds();
  return static_cast<std::size_t>(std::ranges::find(kinds, name) - kinds.begin());
}

std::vector<Hit> hits_with(roots::Method method, const KnownShape& known, const Ray& ray) {
  Geometry geometry;
  geometry.shape = std::get<ExactShape>(known.shape);
  std::get<PolynomialShape>(std::get<ExactShape>(geometry.shape).form).root_finder = method;
  std::vector<Hit> hits;
  all_hits(*build_accel({geometry}), ray, hits);
  return hits;
}

/// The closed form of this ray's quartic misses both crossings, and says that it is not certain.
TEST(RootFinders, ClosedFormsThatAreNotCertainAreReplaced) {
  const KnownShape known = draw_known_shape(kind_named("polynomial_even"), 347);
  const Ray ray{{-0.429169059f, 1.08166683f, 0.817043006f},
                0,
                {21.2589169f, -50.8942223f, -39.3746185f},
                std::numeric_limits<float>::infinity()};
  const std::vector<Hit> expected = hits_with(roots::Method::bernstein, known, ray);
  ASSERT_EQ(expected.size(), 2u);
  for (const roots::Method method : {roots::Method::automatic, roots::Method::closed, roots::Method::sturm}) {
    const std::vector<Hit> hits = hits_with(method, known, ray);
    ASSERT_EQ(hits.size(), 2u) << static_cast<int>(method);
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(hits[i].t, expected[i].t, 1e-7f * expected[i].t);
      EXPECT_EQ(hits[i].v, expected[i].v);
    }
  }
}

/// Polynomials of degree 4 with roots in pairs, whose closed forms are the least certain.
TEST(RootFinders, AgreeOnRandomShapes) {
  for (const char* kind : {"polynomial", "polynomial_even"})
    for (std::uint64_t number = 0; number < 60; ++number) {
      const KnownShape known = draw_known_shape(kind_named(kind), number);
      CaseRandom random(number);
      for (int i = 0; i < 40; ++i) {
        const Vec3f from(random.vector() * 2.0), to(random.vector());
        const Ray ray{from, 0, to - from, std::numeric_limits<float>::infinity()};
        const std::vector<Hit> expected = hits_with(roots::Method::bernstein, known, ray);
        const std::vector<Hit> hits = hits_with(roots::Method::closed, known, ray);
        ASSERT_EQ(hits.size(), expected.size()) << kind << " " << number << ", ray " << i;
        for (std::size_t k = 0; k < hits.size(); ++k)
          EXPECT_NEAR(hits[k].t, expected[k].t, 1e-6f * std::abs(expected[k].t) + 1e-6f);
      }
    }
}

}  // namespace
}  // namespace oktett::root_finders_test
