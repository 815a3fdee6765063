#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/math.h"
#include "kernels/roots/methods.h"
#include "kernels/roots/roots.h"
#include "tests/support/exact_roots.h"
#include "tests/support/limits.h"
#include "tests/support/random_polynomials.h"

namespace oktett::roots::roots_test {
namespace {

using test::judge;
using test::Judgement;
using test::RootClass;
using test::RootProblem;

constexpr Method kMethods[] = {Method::automatic, Method::closed,    Method::bernstein, Method::sturm,
                               Method::laguerre,  Method::bisection, Method::newton};

Polynomial polynomial(std::initializer_list<double> ascending) {
  Polynomial p;
  for (const double c : ascending) p.c[++p.degree] = c;
  return p;
}

Polynomial with_roots(std::initializer_list<double> roots) {
  Polynomial p = polynomial({1});
  for (const double r : roots) {
    p.c[++p.degree] = 0;
    for (int i = p.degree; i >= 0; --i) p.c[i] = (i ? p.c[i - 1] : 0) - r * p.c[i];
  }
  return p;
}

/// The oracle itself, on polynomials whose roots are known.
TEST(ExactRoots, CountsWhatIsKnown) {
  const test::ExactPolynomial p(with_roots({1, 2, 2, 3, 3, 3}));
  EXPECT_EQ(p.count_distinct(0, 4), 3);
  EXPECT_EQ(p.count(0, 4), 6);
  EXPECT_EQ(p.count(1, 2), 3);
  EXPECT_EQ(p.count(1.5, 2), 2);
  EXPECT_EQ(p.count(2, 2), 2);
  EXPECT_EQ(p.count(2.5, 4), 3);
  EXPECT_EQ(p.count_distinct(-kInfinity, kInfinity), 3);
  EXPECT_EQ(p.sign_at(2), 0);
  EXPECT_EQ(p.sign_at(std::nextafter(1, 2)), -1);
  const test::ExactPolynomial none(polynomial({0x1p-1000, 0, 1}));
  EXPECT_EQ(none.count(-1, 1), 0);
  const test::ExactPolynomial close(polynomial({1, -2, std::nextafter(1, 0)}));
  EXPECT_EQ(close.count(0, 2), 2);
}

TEST(ExactRoots, JudgeSeesWrongAnswers) {
  const Polynomial p = with_roots({0.25, 0.5, 0.75});
  Roots right = solve(p, 0, 1);
  ASSERT_EQ(right.count, 3);
  EXPECT_EQ(judge(p, 0, 1, right).missed + judge(p, 0, 1, right).invented, 0);
  Roots fewer = right;
  fewer.count = 2;
  EXPECT_EQ(judge(p, 0, 1, fewer).missed, 1);
  Roots off = right;
  off.root[1].x += 1e-9;
  EXPECT_EQ(judge(p, 0, 1, off).missed, 1);
  EXPECT_EQ(judge(p, 0, 1, off).invented, 1);
  Roots doubled = right;
  doubled.root[1].multiplicity = 2;
  EXPECT_EQ(judge(p, 0, 1, doubled).invented, 1);
}

class CertifiedMethod : public testing::TestWithParam<Method> {};

/// Certified answers are right for all classes of polynomials, and Bernstein certifies nearly all of them.
TEST_P(CertifiedMethod, MissesAndInventsNothing) {
  int uncertified = 0, clusters = 0, problems = 0;
  for (const int degree : {1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 16, 20, 32}) {
    const std::uint64_t count = degree <= 8 ? 150 : degree <= 16 ? 50 : 6;
    for (int c = 0; c < test::kRootClasses; ++c) {
      for (std::uint64_t i = 0; i < count; ++i) {
        const RootProblem q = test::random_problem(static_cast<RootClass>(c), degree, i + 1000000);
        const Roots answer = solve(q.p, q.a, q.b, GetParam());
        ++problems;
        if (!answer.certified) {
          ++uncertified;
          continue;
        }
        const Judgement j = judge(q.p, q.a, q.b, answer);
        clusters += j.clusters;
        EXPECT_EQ(j.missed + j.invented, 0) << to_string(static_cast<RootClass>(c)) << " degree " << degree
                                            << " number " << i << ": " << j.what;
        EXPECT_LT(j.worst_error, 1e-6);
      }
    }
  }
  if (GetParam() == Method::bernstein || GetParam() == Method::automatic) {
    EXPECT_LE(uncertified, problems / 2000);
    EXPECT_GT(clusters, problems / 100);
  }
}
INSTANTIATE_TEST_SUITE_P(Roots, CertifiedMethod,
                         testing::Values(Method::automatic, Method::closed, Method::bernstein, Method::sturm),
                         [](const auto& method) { return to_string(method.param); });

class AnyMethod : public testing::TestWithParam<Method> {};

/// All methods find roots that are far apart.
TEST_P(AnyMethod, FindsWellSeparatedRoots) {
  for (int degree = 1; degree <= 8; ++degree) {
    Polynomial p = polynomial({1});
    for (int k = 0; k < degree; ++k) {
      p.c[++p.degree] = 0;
      for (int i = p.degree; i >= 0; --i) p.c[i] = (i ? p.c[i - 1] : 0) - (k - 3.25) * p.c[i];
    }
    const Roots answer = solve(p, -10, 10, GetParam());
    ASSERT_EQ(answer.count, degree);
    for (int k = 0; k < degree; ++k) {
      EXPECT_NEAR(answer.root[k].x, k - 3.25, 1e-10);
      EXPECT_LE(std::abs(answer.root[k].x - (k - 3.25)), answer.root[k].error);
    }
  }
}

TEST_P(AnyMethod, BadInputIsNotCertified) {
  for (const double bad : {kNanDouble, kInfinity, -kInfinity}) {
    for (int i = 0; i < 4; ++i) {
      Polynomial p = polynomial({-1, 2, 3, 4});
      p.c[i] = bad;
      const Roots answer = solve(p, 0, 1, GetParam());
      EXPECT_EQ(answer.count, 0);
      EXPECT_FALSE(answer.certified);
    }
  }
  const Polynomial p = polynomial({-1, 2});
  EXPECT_FALSE(solve(p, kNanDouble, 1, GetParam()).certified);
  EXPECT_FALSE(solve(p, 0, kNanDouble, GetParam()).certified);
  Polynomial large;
  large.degree = kMaxDegree + 1;
  EXPECT_FALSE(solve(large, 0, 1, GetParam()).certified);
}

TEST_P(AnyMethod, DegenerateInputHasItsAnswer) {
  const Roots zero = solve(polynomial({0, 0, 0}), 0, 1, GetParam());
  EXPECT_TRUE(zero.everywhere && zero.certified && zero.count == 0);
  const Roots none = solve(Polynomial{}, 0, 1, GetParam());
  EXPECT_TRUE(none.everywhere);
  const Roots constant = solve(polynomial({5, 0, 0}), -1, 1, GetParam());
  EXPECT_TRUE(constant.certified && constant.count == 0 && !constant.everywhere);
  const Roots reversed = solve(with_roots({0.5}), 1, 0, GetParam());
  EXPECT_TRUE(reversed.certified && reversed.count == 0);
  // Leading zeros, and roots at zero.
  const Roots leading = solve(polynomial({-0.5, 1, 0, 0, 0}), 0, 1, GetParam());
  ASSERT_EQ(leading.count, 1);
  EXPECT_NEAR(leading.root[0].x, 0.5, 1e-15);
  const Roots powers = solve(polynomial({0, 0, 0, -0.5, 1}), -1, 1, GetParam());
  ASSERT_EQ(powers.count, 2);
  EXPECT_EQ(powers.root[0].x, 0);
  EXPECT_EQ(powers.root[0].multiplicity, 3);
  EXPECT_NEAR(powers.root[1].x, 0.5, 1e-15);
  EXPECT_EQ(solve(polynomial({0, 0, 1}), 1, 2, GetParam()).count, 0);
}

/// Roots come in order, within the interval.
TEST_P(AnyMethod, RootsAreInOrder) {
  for (int degree = 2; degree <= 12; ++degree) {
    for (int c = 0; c < test::kRootClasses; ++c) {
      for (std::uint64_t i = 0; i < 50; ++i) {
        const RootProblem q = test::random_problem(static_cast<RootClass>(c), degree, i);
        const Roots answer = solve(q.p, q.a, q.b, GetParam());
        for (int k = 0; k < answer.count; ++k) {
          EXPECT_TRUE(answer.root[k].x >= q.a && answer.root[k].x <= q.b);
          EXPECT_TRUE(answer.root[k].error >= 0 && answer.root[k].multiplicity >= 1);
          if (k) {
            EXPECT_LE(answer.root[k - 1].x, answer.root[k].x);
          }
        }
      }
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Roots, AnyMethod, testing::ValuesIn(kMethods),
                         [](const auto& method) { return to_string(method.param); });

TEST(Roots, ExactDoubleRootIsOneCluster) {
  const Roots answer = solve(with_roots({0.5, 0.5, 0.8125}), 0, 1);
  ASSERT_TRUE(answer.certified);
  ASSERT_EQ(answer.count, 2);
  EXPECT_EQ(answer.root[0].multiplicity, 2);
  EXPECT_LE(answer.root[0].error, 1e-12);
  EXPECT_LE(std::abs(answer.root[0].x - 0.5), answer.root[0].error);
  EXPECT_EQ(answer.root[1].multiplicity, 1);
}

/// (x - 1/2)^2 +- d: the two cases are distinguished for d far below the resolution of values in double.
TEST(Roots, NearTangentIsDecidedExactly) {
  for (const double d : {1e-10, 1e-16, 1e-22, 1e-26}) {
    // x^2 - x + 1/4 +- d, times a power of two that lets d survive next to 1/4: shift the root to 2^-20.
    const double s = 0x1p-20;
    const Roots apart = solve(polynomial({s * s - d * 1e-3, -2 * s, 1}), 0, 1);
    EXPECT_EQ(apart.count, s * s - d * 1e-3 == s * s ? 1 : 2) << d;
    EXPECT_TRUE(apart.certified);
    const Roots above = solve(polynomial({s * s + d * 1e-3, -2 * s, 1}), 0, 1);
    EXPECT_EQ(above.count, s * s + d * 1e-3 == s * s ? 1 : 0) << d;
    EXPECT_TRUE(above.certified);
  }
}

TEST(Roots, EndsOfTheIntervalBelongToIt) {
  const Polynomial p = with_roots({0.25, 0.5, 0.75});
  const Roots answer = solve(p, 0.25, 0.75);
  ASSERT_TRUE(answer.certified);
  ASSERT_EQ(answer.count, 3);
  EXPECT_EQ(solve(p, 0.5, 0.5).count, 1);
  EXPECT_EQ(solve(p, 0.3, 0.4).count, 0);
  EXPECT_EQ(solve(p, std::nextafter(0.5, 1), 0.7).count, 0);
}

TEST(Roots, IntervalsMayBeInfinite) {
  const Polynomial p = with_roots({-1e6, -3, 0.001, 7e8});
  for (const auto& [a, b, count] :
       {std::tuple{-kInfinity, kInfinity, 4}, {0.0, kInfinity, 2}, {-kInfinity, 0.0, 2}, {1.0, 1e300, 1}}) {
    const Roots answer = solve(p, a, b);
    EXPECT_TRUE(answer.certified);
    EXPECT_EQ(answer.count, count);
  }
}

TEST(Roots, OnlyTheFirstIfOnlyTheFirstIsWanted) {
  for (int degree = 2; degree <= 8; ++degree) {
    for (std::uint64_t i = 0; i < 300; ++i) {
      const RootProblem q = test::random_problem(static_cast<RootClass>(i % test::kRootClasses), degree, i);
      const Roots all = solve(q.p, q.a, q.b), one = solve(q.p, q.a, q.b, Method::automatic, 1);
      ASSERT_EQ(one.count, std::min(all.count, 1));
      if (one.count) {
        EXPECT_LE(std::abs(one.root[0].x - all.root[0].x), one.root[0].error + all.root[0].error);
      }
    }
  }
}

/// Multiplying value and variable by powers of two multiplies the answer, bit for bit.
TEST(Roots, PowersOfTwoChangeNothing) {
  for (int degree = 1; degree <= 9; ++degree) {
    for (std::uint64_t i = 0; i < 100; ++i) {
      const RootProblem q = test::random_problem(RootClass::spread, degree, i);
      const Roots plain = solve(q.p, q.a, q.b);
      for (const int shift : {-40, 3, 60}) {
        Polynomial p = q.p;
        for (int k = 0; k <= degree; ++k) p.c[k] = std::ldexp(p.c[k], 17 - k * shift);
        const Roots scaled = solve(p, std::ldexp(q.a, shift), std::ldexp(q.b, shift));
        ASSERT_EQ(scaled.count, plain.count);
        for (int k = 0; k < plain.count; ++k) {
          EXPECT_EQ(scaled.root[k].x, std::ldexp(plain.root[k].x, shift));
          EXPECT_EQ(scaled.root[k].error, std::ldexp(plain.root[k].error, shift));
        }
      }
    }
  }
}

/// Coefficients at the ends of the range of double.
TEST(Roots, HugeAndTinyCoefficients) {
  for (const double scale : {0x1p-1060, 0x1p-1000, 0x1p1000, 0x1p1020}) {
    Polynomial p = with_roots({0.25, 0.5, 0.875});
    for (int k = 0; k <= p.degree; ++k) p.c[k] *= scale;
    const Judgement j = judge(p, 0, 1, solve(p, 0, 1));
    EXPECT_EQ(j.missed + j.invented, 0) << j.what;
    EXPECT_EQ(solve(p, 0, 1).count, 3);
  }
  // Roots at 2^-100, 1 and 2^100.
  const Polynomial wide = polynomial({-1, 0x1p100, -0x1p100, 1});
  for (const auto& [b, count] : {std::pair{0x1p600, 3}, {kInfinity, 3}, {2.0, 2}}) {
    const Roots answer = solve(wide, 0, b);
    EXPECT_EQ(answer.count, count);
    EXPECT_TRUE(answer.certified);
  }
  // Roots farther apart than doubles reach are not all found, and that is not hidden.
  EXPECT_FALSE(solve(polynomial({-1, 0x1p500, -0x1p500, 1}), 0, kInfinity).certified);
}

}  // namespace
}  // namespace oktett::roots::roots_test
