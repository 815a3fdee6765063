#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "kernels/interval/dual.h"

namespace oktett::interval_test {
namespace {

using D = Simd<double, 1, ScalarIsa>;
using I = Interval<D>;
using J = Dual<I>;
using L = long double;

double number(const D& d) { return d.part[0].v; }
bool holds(const I& i, L x) { return number(i.lo) <= x && x <= number(i.hi); }
bool is_entire(const I& i) { return any(i.is_entire()); }
bool is_void(const I& i) { return any(i.is_void()); }
L width(const I& i) { return static_cast<L>(number(i.hi)) - number(i.lo); }

/// Arguments of all kinds: ordinary, huge, tiny, whole, near multiples of pi/2, zero.
class Arguments {
 public:
  double draw() {
    switch (random_() % 8) {
      case 0:
        return unit();
      case 1:
        return 10 * unit();
      case 2:
        return std::ldexp(unit(), static_cast<int>(random_() % 60) - 30);
      case 3:
        return std::ldexp(unit(), static_cast<int>(random_() % 2000) - 1000);
      case 4:
        return static_cast<double>(static_cast<int>(random_() % 17) - 8) / 2;
      case 5:
        return static_cast<double>(std::numbers::pi_v<L> / 2 * (static_cast<int>(random_() % 4001) - 2000)) *
               (1 + static_cast<double>(static_cast<int>(random_() % 3) - 1) * 0x1p-52);
      case 6:
        return 1000 * unit();
      default:
        return 1 + std::ldexp(unit(), -static_cast<int>(random_() % 50));
    }
  }
  /// An interval and points in it, the ends among them.
  I interval(std::vector<double>& points) {
    double a = draw(), b = random_() % 3 == 0 ? a : random_() % 2 == 0 ? draw() : a * (1 + 0x1p-30 * unit());
    if (a > b) std::swap(a, b);
    points = {a, b};
    for (int i = 0; i < 4; ++i) {
      const double p = a + (b - a) * std::abs(unit());
      if (a <= p && p <= b) points.push_back(p);
    }
    if (a <= 0 && 0 <= b) points.push_back(0);
    return {D(a), D(b)};
  }
  double unit() { return std::ldexp(static_cast<double>(static_cast<std::int64_t>(random_())), -63); }

 private:
  std::mt19937_64 random_{1};
};

/// The interval contains the true value, up to the error of the oracle, whose x87 functions are good to
/// 2^-62.
void expect_held(const I& result, L truth, const std::string& what) {
  if (std::isnan(truth)) {
    // Beside a pole the values are unbounded to one side.
    EXPECT_TRUE(is_void(result) || !any(result.is_bounded())) << what;
  } else {
    ASSERT_FALSE(is_void(result)) << what;
    const L slack = std::abs(truth) * 0x1p-61L;
    EXPECT_TRUE(std::isinf(truth) ? holds(result, truth) || is_entire(result)
                                  : number(result.lo) <= truth + slack && truth - slack <= number(result.hi))
        << what << ": " << static_cast<double>(truth) << " not in [" << number(result.lo) << ", "
        << number(result.hi) << "]";
  }
}

struct Unary {
  const char* name;
  std::function<I(const I&)> f;
  std::function<L(L)> truth;
  /// Width allowed at a point, relative to max(|f|, floor).
  double relative = 0x1p-45, floor = 0;
};

L whole_sign(L x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }
L only(bool defined, L x) { return defined ? x : std::numeric_limits<L>::quiet_NaN(); }

std::vector<Unary> unaries() {
  return {
      {"negate", [](const I& a) { return -a; }, [](L x) { return -x; }},
      {"abs", [](const I& a) { return abs(a); }, [](L x) { return std::abs(x); }},
      {"sqr", [](const I& a) { return sqr(a); }, [](L x) { return x * x; }},
      {"inverse", [](const I& a) { return inverse(a); }, [](L x) { return only(x != 0, 1 / x); }},
      {"sqrt", [](const I& a) { return sqrt(a); }, [](L x) { return std::sqrt(x); }},
      {"exp", [](const I& a) { return exp(a); }, [](L x) { return std::exp(x); }, 0x1p-36},
      {"exp2", [](const I& a) { return exp2(a); }, [](L x) { return std::exp2(x); }},
      {"log", [](const I& a) { return log(a); }, [](L x) { return only(x > 0, std::log(x)); }},
      {"sin", [](const I& a) { return sin(a); }, [](L x) { return std::sin(x); }, 0x1p-45, 1},
      {"cos", [](const I& a) { return cos(a); }, [](L x) { return std::cos(x); }, 0x1p-45, 1},
      {"tan", [](const I& a) { return tan(a); }, [](L x) { return std::tan(x); }, 1e300, 1},
      {"atan", [](const I& a) { return atan(a); }, [](L x) { return std::atan(x); }},
      {"asin", [](const I& a) { return asin(a); }, [](L x) { return std::asin(x); }},
      {"acos", [](const I& a) { return acos(a); }, [](L x) { return std::acos(x); }},
      {"pow 3", [](const I& a) { return pow(a, 3); }, [](L x) { return x * x * x; }},
      {"pow 12", [](const I& a) { return pow(a, 12); }, [](L x) { return std::pow(x, 12.0L); }},
      {"pow -5", [](const I& a) { return pow(a, -5); }, [](L x) { return only(x != 0, std::pow(x, -5.0L)); }},
      {"pow 1.7", [](const I& a) { return pow(a, 1.7); },
       [](L x) { return only(x >= 0, std::pow(x, static_cast<L>(1.7))); }, 0x1p-37},
      {"pow 0.3", [](const I& a) { return pow(a, 0.3); },
       [](L x) { return only(x >= 0, std::pow(x, static_cast<L>(0.3))); }, 0x1p-37},
      {"pow -2.5", [](const I& a) { return pow(a, -2.5); },
       [](L x) { return only(x > 0, std::pow(x, -2.5L)); }, 0x1p-36},
      {"floor", [](const I& a) { return floor(a); }, [](L x) { return std::floor(x); }},
      {"ceil", [](const I& a) { return ceil(a); }, [](L x) { return std::ceil(x); }},
      {"round", [](const I& a) { return round(a); }, [](L x) { return std::round(x); }},
      {"sign", [](const I& a) { return sign(a); }, whole_sign},
  };
}

/// The interval version contains every value of the function on the interval. At points it is tight. A result
/// that may be undefined is never certain.
TEST(Interval, UnaryFunctionsHoldEveryValue) {
  for (const Unary& u : unaries()) {
    Arguments arguments;
    std::vector<double> points;
    for (int k = 0; k < 10000; ++k) {
      const I a = arguments.interval(points);
      const I r = u.f(a);
      for (const double x : points) {
        const L truth = u.truth(x);
        expect_held(r, truth, u.name + std::string(" of ") + std::to_string(x));
        // At a point the enclosure is narrow, but for sines of angles beyond their range.
        if (std::abs(truth) < 1e250L && std::abs(x) < lane::kMaxAngle) {
          const I at = u.f(I(D(x)));
          const L scale = std::max(std::abs(truth), static_cast<L>(u.floor)) + 1e-250L;
          EXPECT_TRUE(is_entire(at) || width(at) <= u.relative * scale) << u.name << " at " << x;
        }
      }
      if (::testing::Test::HasFailure()) return;
    }
  }
}

struct Binary {
  const char* name;
  std::function<I(const I&, const I&)> f;
  std::function<L(L, L)> truth;
};

TEST(Interval, BinaryFunctionsHoldEveryValue) {
  const std::vector<Binary> binaries = {
      {"+", [](const I& a, const I& b) { return a + b; }, [](L x, L y) { return x + y; }},
      {"-", [](const I& a, const I& b) { return a - b; }, [](L x, L y) { return x - y; }},
      {"*", [](const I& a, const I& b) { return a * b; }, [](L x, L y) { return x * y; }},
      {"by a number", [](const I& a, const I& b) { return a * b.lo; }, nullptr},
      {"/", [](const I& a, const I& b) { return a / b; }, [](L x, L y) { return only(y != 0, x / y); }},
      {"min", [](const I& a, const I& b) { return min(a, b); }, [](L x, L y) { return std::min(x, y); }},
      {"max", [](const I& a, const I& b) { return max(a, b); }, [](L x, L y) { return std::max(x, y); }},
      {"hull", [](const I& a, const I& b) { return hull(a, b); }, [](L x, L) { return x; }},
      {"atan2", [](const I& a, const I& b) { return atan2(a, b); },
       [](L x, L y) { return std::atan2(x, y); }},
  };
  for (const Binary& f : binaries) {
    Arguments arguments;
    std::vector<double> xs, ys;
    for (int k = 0; k < 10000; ++k) {
      const I a = arguments.interval(xs), b = arguments.interval(ys), r = f.f(a, b);
      for (const double x : xs)
        for (const double y : ys) {
          const L truth = f.truth ? f.truth(x, y) : static_cast<L>(x) * number(b.lo);
          expect_held(r, truth, f.name + std::string(" of ") + std::to_string(x) + ", " + std::to_string(y));
          if (::testing::Test::HasFailure()) return;
        }
    }
  }
}

/// Every function passes entire and void arguments on, so nothing certain follows from them.
TEST(Interval, UndefinedStaysUndefined) {
  const I entire = I::entire(), none = I::nothing(), zero{D(0.0)}, one{D(1.0)};
  for (const Unary& u : unaries()) {
    EXPECT_TRUE(is_entire(u.f(entire))) << u.name;
    EXPECT_TRUE(is_void(u.f(none))) << u.name;
  }
  for (const I& other : {zero, one, I(D(-1.0), D(2.0)), entire}) {
    for (const I& r : {entire + other, entire - other, other - entire, entire * other, other * entire,
                       entire / (other + I(D(3.0))), min(entire, other), max(entire, other),
                       hull(entire, other), atan2(entire, other), atan2(other, entire), entire * D(0.0)})
      EXPECT_TRUE(is_entire(r));
    for (const I& r : {none + other, none * other, other * none, none / other, other / none, min(none, other),
                       max(other, none), hull(other, none), atan2(none, other), none * D(0.0)})
      EXPECT_TRUE(is_void(r));
  }
  EXPECT_TRUE(is_void(sqrt(I(D(-2.0), D(-1.0)))));
  EXPECT_TRUE(is_entire(sqrt(I(D(-2.0), D(1.0)))));
  EXPECT_TRUE(is_entire(inverse(I(D(-1.0), D(1.0)))));
  EXPECT_FALSE(is_entire(inverse(I(D(0.0), D(1.0)))));
  EXPECT_TRUE(is_entire(tan(I(D(1.5), D(1.6)))));
  EXPECT_TRUE(is_void(asin(I(D(1.5), D(1.6)))));
  EXPECT_TRUE(is_void(zero / zero) && is_void(one / zero));
}

/// Sums and products of non-negative intervals are not negative, so sqrt(x^2 + y^2) is defined.
TEST(Interval, KeepsTheSignOfZero) {
  const I zero{D(0.0)}, one(D(0.0), D(1.0));
  EXPECT_EQ(number((sqr(zero) + sqr(one)).lo), 0);
  EXPECT_EQ(number((one * one).lo), 0);
  EXPECT_EQ(number(pow(one, 3).lo), 0);
  EXPECT_FALSE(is_entire(sqrt(sqr(zero) + sqr(one))));
}

/// The derivative over an interval contains the slope of every chord, as the mean value theorem needs.
TEST(Interval, DerivativesHoldEverySlope) {
  struct Case {
    const char* name;
    std::function<J(const J&)> f;
    std::function<L(L)> truth;
  };
  const std::vector<Case> cases = {
      {"product", [](const J& a) { return a * a * a; }, [](L x) { return x * x * x; }},
      {"quotient",
       [](const J& a) {
         return a / (a + J{I(D(3.0)), I(D(0.0))});
       },
       [](L x) { return x / (x + 3); }},
      {"sqr", [](const J& a) { return sqr(a); }, [](L x) { return x * x; }},
      {"sqrt", [](const J& a) { return sqrt(a); }, [](L x) { return std::sqrt(x); }},
      {"abs", [](const J& a) { return abs(a); }, [](L x) { return std::abs(x); }},
      {"exp", [](const J& a) { return exp(a); }, [](L x) { return std::exp(x); }},
      {"log", [](const J& a) { return log(a); }, [](L x) { return std::log(x); }},
      {"sin", [](const J& a) { return sin(a); }, [](L x) { return std::sin(x); }},
      {"cos", [](const J& a) { return cos(a); }, [](L x) { return std::cos(x); }},
      {"tan", [](const J& a) { return tan(a); }, [](L x) { return std::tan(x); }},
      {"atan", [](const J& a) { return atan(a); }, [](L x) { return std::atan(x); }},
      {"asin", [](const J& a) { return asin(a); }, [](L x) { return std::asin(x); }},
      {"acos", [](const J& a) { return acos(a); }, [](L x) { return std::acos(x); }},
      {"pow 7", [](const J& a) { return pow(a, 7); }, [](L x) { return std::pow(x, 7.0L); }},
      {"pow -2", [](const J& a) { return pow(a, -2); }, [](L x) { return std::pow(x, -2.0L); }},
      {"pow 2.5", [](const J& a) { return pow(a, 2.5); }, [](L x) { return std::pow(x, 2.5L); }},
      {"pow 0.5", [](const J& a) { return pow(a, 0.5); }, [](L x) { return std::pow(x, 0.5L); }},
      {"max", [](const J& a) { return max(a, sqr(a)); }, [](L x) { return std::max(x, x * x); }},
      {"min", [](const J& a) { return min(a, sqr(a)); }, [](L x) { return std::min(x, x * x); }},
      {"atan2", [](const J& a) { return atan2(sqr(a), a); }, [](L x) { return std::atan2(x * x, x); }},
      {"floor", [](const J& a) { return floor(a); }, [](L x) { return std::floor(x); }},
      {"sign", [](const J& a) { return sign(a); }, whole_sign},
  };
  for (const Case& c : cases) {
    Arguments arguments;
    int slopes = 0;
    for (int k = 0; k < 4000; ++k) {
      double a = 4 * arguments.unit(), b = k % 2 == 0 ? 4 * arguments.unit() : a + 1e-3 * arguments.unit();
      if (a > b) std::swap(a, b);
      const J r = c.f({I(D(a), D(b)), I(D(1.0))});
      if (!any(r.v.is_bounded() & r.d.is_bounded())) continue;
      for (int i = 0; i < 6; ++i) {
        const L p = a + (b - a) * std::abs(arguments.unit()), q = i < 2 ? (i == 0 ? a : b) : (a + b) / 2;
        if (p == q || p < a || p > b) continue;
        ++slopes;
        const L slope = (c.truth(p) - c.truth(q)) / (p - q),
                slack = 1e-18L * std::abs(c.truth(p)) / std::abs(p - q);
        EXPECT_TRUE(number(r.d.lo) <= slope + slack + 1e-15L * std::abs(slope) &&
                    slope - slack - 1e-15L * std::abs(slope) <= number(r.d.hi))
            << c.name << " over [" << a << ", " << b << "]: " << static_cast<double>(slope) << " not in ["
            << number(r.d.lo) << ", " << number(r.d.hi) << "]";
      }
      if (::testing::Test::HasFailure()) return;
    }
    EXPECT_GT(slopes, 500) << c.name;
  }
}

}  // namespace
}  // namespace oktett::interval_test
