#include "kernels/exact/piece_march.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "tests/support/random_roots.h"

namespace oktett::piece_march_test {
namespace {

constexpr int kRoom = 24;

/// The product of t - r over roots r, in the mean value form about the middle of the piece.
template <class D>
struct Product {
  std::vector<double> roots;
  double factor;
  mutable int evaluations = 0;

  Dual<Interval<D>> value(const Dual<Interval<D>>& t) const {
    Dual<Interval<D>> p{Interval<D>(D(factor)), Interval<D>(D(0.0))};
    for (const double r : roots) p = p * (t - Dual<Interval<D>>{Interval<D>(D(r)), Interval<D>(D(0.0))});
    return p;
  }
  Dual<Interval<D>> over(const Interval<D>& t) const {
    ++evaluations;
    const Interval<D> m(t.lo + (t.hi - t.lo) * D(0.5));
    Dual<Interval<D>> f = value({t, Interval<D>(D(1.0))});
    f.v = intersect(f.v, at(m.lo) + f.d * (t - m));
    return f;
  }
  Interval<D> at(const D& t) const { return value({Interval<D>(t), Interval<D>(D(0.0))}).v; }
};

struct Found {
  std::vector<double> t, turn;
  double up_to;
  int evaluations;
};

using D = Simd<double, 8, ScalarIsa>;

/// The same, which also tells less with less: floats about what is known to a few bits.
struct RoughProduct : Product<D> {
  using F = Simd<float, 8, ScalarIsa>;
  static Interval<F> roughly(const Interval<D>& f) {
    const D off = (abs(f.lo) + abs(f.hi)) * D(0x1p-4) + D(1e-30);
    return {to_float(f.lo - off), to_float(f.hi + off)};
  }
  Dual<Interval<F>> over_roughly(const double* ends) const {
    const Dual<Interval<D>> f = over({D::load(ends), D::load(ends + 1)});
    return {roughly(f.v), roughly(f.d)};
  }
  Interval<F> at_roughly(const double* places) const { return roughly(at(D::load(places))); }
};

template <int K, class Field>
Found find_in(const Field& field, double a, double b, double limit) {
  const interval::PieceMarch<K, Field, D> march(field, a, b, limit, b - a);
  Found found;
  march.each((b - a) * 0x1p-42,
             [&](double x, double before) { found.t.push_back(x), found.turn.push_back(-before); });
  found.up_to = march.up_to(), found.evaluations = field.evaluations;
  return found;
}

/// What is found with and without the rough enclosure.
template <int K = kRoom>
Found find(const std::vector<double>& roots, double factor = 1, double a = 0, double b = 1,
           double limit = 0) {
  limit = std::max(b, limit);
  const Found found = find_in<K>(Product<D>{roots, factor}, a, b, limit);
  const Found roughly = find_in<K>(RoughProduct{{roots, factor}}, a, b, limit);
  EXPECT_EQ(found.t.size(), roughly.t.size());
  for (std::size_t i = 0; i < std::min(found.t.size(), roughly.t.size()); ++i)
    EXPECT_NEAR(found.t[i], roughly.t[i], 1e-4);
  EXPECT_EQ(found.turn, roughly.turn);
  return found;
}

void expect_roots(const Found& found, const std::vector<double>& roots, double first_turn,
                  double tolerance = 1e-11) {
  ASSERT_EQ(found.t.size(), roots.size());
  for (std::size_t i = 0; i < roots.size(); ++i) {
    EXPECT_NEAR(found.t[i], roots[i], tolerance);
    EXPECT_EQ(found.turn[i], i % 2 == 0 ? first_turn : -first_turn);
  }
}

TEST(PieceMarch, FindsKnownRoots) {
  expect_roots(find({0.3}), {0.3}, 1);
  expect_roots(find({0.1, 0.5, 0.7, 0.70001, 0.9}), {0.1, 0.5, 0.7, 0.70001, 0.9}, 1);
  expect_roots(find({0.5, 0.5 + 1e-6}, -1), {0.5, 0.5 + 1e-6}, 1, 1e-9);
  expect_roots(find({-1, 2}), {}, 1);
  expect_roots(find({}), {}, 1);
  expect_roots(find({0.3}, 1, 0.5, 0.2), {}, 1);
  expect_roots(find({0.3}, 1, 0.2, 0.2), {}, 1);
}

/// Random roots, far apart or close together, are all found, as far as doubles can resolve them.
TEST(PieceMarch, FindsRandomRoots) {
  std::mt19937 random(5);
  int checked = 0;
  for (int k = 0; k < 2000; ++k) {
    const std::vector<double> roots = test::random_roots(random);
    if (test::least_gap(roots) < 1e-5 || (!roots.empty() && roots.back() >= 1)) continue;
    ++checked;
    expect_roots(find(roots), roots, roots.size() % 2 == 1 ? 1 : -1, 1e-9);
  }
  EXPECT_GT(checked, 1500);
}

/// Touching is no crossing; it costs few pieces although rounding hides the sign.
TEST(PieceMarch, PassesOverTouching) {
  const Found one = find({0.3, 0.3});
  EXPECT_TRUE(one.t.empty());
  EXPECT_LT(one.evaluations, 1000);
  EXPECT_TRUE(find({0.3, 0.3, 0.7, 0.7}, -1).t.empty());
  expect_roots(find({0.3, 0.3, 0.6}), {0.6}, 1);
  EXPECT_TRUE(find({0.3, 0.3, 0.3, 0.3}).t.empty());
  expect_roots(find({0.3, 0.3, 0.3}), {0.3}, 1, 1e-4);
}

/// A ray that lies in the surface all along is given up, and counted.
TEST(PieceMarch, GivesUpWhereNothingIsTold) {
  const std::uint64_t before = interval::uncertified_count();
  const Found zero = find_in<kRoom>(Product<D>{{0.5}, 0}, 0, 1, 1);
  EXPECT_TRUE(zero.t.empty());
  EXPECT_LE(zero.evaluations * 8, interval::kMaxSteps);
  EXPECT_EQ(interval::uncertified_count(), before + 1);
}

/// The same, of which little is proved.
struct VagueProduct : Product<D> {
  static Interval<D> vague(const Interval<D>& f) { return {f.lo - D(1e-5), f.hi + D(1e-5)}; }
  Dual<Interval<D>> over(const Interval<D>& t) const {
    const Dual<Interval<D>> f = Product<D>::over(t);
    return {vague(f.v), f.d};
  }
  Interval<D> at(const D& t) const { return vague(Product<D>::at(t)); }
};

/// Where rounding may hide the sign, the likely one is followed.
TEST(PieceMarch, FindsPlacesBetterThanTheyAreProved) {
  for (const double root : {0.1, 0.3, 0.7123}) {
    const Found found = find_in<kRoom>(VagueProduct{{{root, 0.9}, 1}}, 0, 1, 1);
    ASSERT_EQ(found.t.size(), 2u);
    EXPECT_NEAR(found.t[0], root, 1e-10);
    EXPECT_NEAR(found.t[1], 0.9, 1e-10);
  }
}

/// A crossing at the end of the range is followed beyond the end if that is allowed, and no other.
TEST(PieceMarch, SettlesTheEnd) {
  EXPECT_TRUE(find({0.5}, 1, 0, 0.5, 0.5).t.empty());
  expect_roots(find({0.5}, 1, 0, 0.5, 1), {0.5}, 1);
  EXPECT_TRUE(find({0.5, 0.75}, 1, 0, 0.25, 1).t.empty());
  // It begins there: the sign at the beginning cannot be told, so that there is none before.
  EXPECT_TRUE(find({0.5}, 1, 0.5, 1, 1).t.empty());
}

/// With one zero, on whose sides the slope differs, and steps beyond which the values are those of other
/// slopes: as lower bounds of a function that are not all as good.
template <class D>
struct Stepped {
  double zero, step, slopes[4];

  D value(const D& t) const {
    const D way = t - D(zero);
    const D before = select(way < D(-step), D(slopes[0]), D(slopes[1]));
    const D behind = select(way < D(step), D(slopes[2]), D(slopes[3]));
    return way * select(way < D(0.0), before, behind);
  }
  Interval<D> at(const D& t) const {
    const D f = value(t), error = abs(f) * D(0x1p-50) + D(1e-300);
    return {f - error, f + error};
  }
  /// The sign of its values is that of the way to the zero.
  Dual<Interval<D>> over(const Interval<D>& t) const {
    const D lo = t.lo - D(zero), hi = t.hi - D(zero), least(1e-9), most(1e9);
    return {{min(lo * least, lo * most), max(hi * least, hi * most)}, {least, most}};
  }
};

/// Where the chord is a poor guide.
TEST(PieceMarch, FindsZerosWhereValuesStep) {
  std::mt19937 random(7);
  const auto power = [&] { return std::exp2(random() % 21 - 10.0); };
  for (int k = 0; k < 5000; ++k) {
    const Stepped<D> stepped{
        (random() + 0.5) / 4294967296.0, power() * 0.01, {power(), power(), power(), power()}};
    const interval::PieceMarch<1, Stepped<D>, D> march(stepped, 0, 1, 1, 1);
    int found = 0;
    march.each(0x1p-42, [&](double x, double before) {
      ++found;
      EXPECT_EQ(before, -1);
      EXPECT_NEAR(x, stepped.zero, 1e-11);
    });
    EXPECT_EQ(found, 1);
  }
}

/// A march that is resumed where the last one was full finds the same crossings.
TEST(PieceMarch, ResumesWhereItStopped) {
  std::vector<double> roots, all;
  for (int i = 1; i < 12; ++i) roots.push_back(i / 12.0 + 1e-3);
  for (double a = 0; a < 1;) {
    const Found part = find<3>(roots, 1, a, 1, 1);
    EXPECT_LE(part.t.size(), 3u);
    all.insert(all.end(), part.t.begin(), part.t.end());
    a = part.up_to;
  }
  ASSERT_EQ(all.size(), roots.size());
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_NEAR(all[i], roots[i], 1e-11);
}

}  // namespace
}  // namespace oktett::piece_march_test
