#include "core/double_double.h"

#include <gmp.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/random_polynomials.h"

namespace oktett::roots::double_double_test {
namespace {

/// Relative distance of a result from the exact one, given as a rational number.
double relative_error(const DoubleDouble& got, mpq_t exact) {
  mpq_t x, y;
  mpq_inits(x, y, nullptr);
  mpq_set_d(x, got.hi);
  mpq_set_d(y, got.lo);
  mpq_add(x, x, y);
  mpq_sub(x, x, exact);
  const double difference = std::abs(mpq_get_d(x)), size = std::abs(mpq_get_d(exact));
  mpq_clears(x, y, nullptr);
  return difference == 0 ? 0 : difference / size;
}

/// Sum, product and quotient of random operands, which may nearly cancel, against rational arithmetic.
TEST(DoubleDouble, OperationsAreWithinTheirBounds) {
  test::Sequence random(1);
  mpq_t a, b, t, exact;
  mpq_inits(a, b, t, exact, nullptr);
  double worst[3] = {};
  for (int i = 0; i < 20000; ++i) {
    const double hi = std::ldexp(random.uniform(-1, 1), random.below(60) - 30);
    const DoubleDouble x = two_sum(hi, hi * random.uniform(-1, 1) * 0x1p-53);
    const double other = random.below(2)
                             ? -hi * (1 + random.uniform(-1, 1) * std::ldexp(1, -random.below(50)))
                             : random.uniform(-1, 1);
    const DoubleDouble y = two_sum(other, other * random.uniform(-1, 1) * 0x1p-53);
    mpq_set_d(a, x.hi), mpq_set_d(t, x.lo), mpq_add(a, a, t);
    mpq_set_d(b, y.hi), mpq_set_d(t, y.lo), mpq_add(b, b, t);
    mpq_add(exact, a, b);
    worst[0] = std::max(worst[0], relative_error(x + y, exact));
    mpq_mul(exact, a, b);
    worst[1] = std::max(worst[1], relative_error(x * y, exact));
    mpq_div(exact, a, b);
    worst[2] = std::max(worst[2], relative_error(x / y, exact));
  }
  mpq_clears(a, b, t, exact, nullptr);
  EXPECT_LT(worst[0], kUnit<DoubleDouble>);
  EXPECT_LT(worst[1], kUnit<DoubleDouble>);
  EXPECT_LT(worst[2], 4 * kUnit<DoubleDouble>);
  // Nor are they exact: the comparison sees errors.
  for (const double e : worst) EXPECT_GT(e, 0x1p-112);
}

TEST(DoubleDouble, TransformationsAreFreeOfError) {
  test::Sequence random(2);
  mpq_t a, b, t;
  mpq_inits(a, b, t, nullptr);
  for (int i = 0; i < 20000; ++i) {
    const double x = std::ldexp(random.uniform(-1, 1), random.below(200) - 100);
    const double y = std::ldexp(random.uniform(-1, 1), random.below(200) - 100);
    for (const bool product : {false, true}) {
      const DoubleDouble r = product ? two_product(x, y) : two_sum(x, y);
      mpq_set_d(a, x), mpq_set_d(b, y);
      product ? mpq_mul(a, a, b) : mpq_add(a, a, b);
      mpq_set_d(b, r.hi), mpq_set_d(t, r.lo);
      mpq_add(b, b, t);
      ASSERT_TRUE(mpq_equal(a, b)) << x << ' ' << y << ' ' << product;
    }
  }
  mpq_clears(a, b, t, nullptr);
}

}  // namespace
}  // namespace oktett::roots::double_double_test
