/// \file Prisms against values that are known.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "accel/point_query.h"
#include "tests/accel/all_crossings.h"
#include "verify/cases/kernel_cases.h"
#include "verify/checks/exact.h"
#include "verify/oracles/exact.h"

namespace oktett::prisms_test {
namespace {

using Curve = PrismShape::Curve;
using Sweep = PrismShape::Sweep;

constexpr float kInf = std::numeric_limits<float>::infinity();

std::vector<Hit> crossings(const PrismShape& s, const Vec3f& o, const Vec3f& d) {
  return all_crossings(s, {o, 0, d, kInf});
}

/// Crossings at these places, in and out in turn.
void expect_at(const std::vector<Hit>& hits, const std::vector<float>& t) {
  ASSERT_EQ(hits.size(), t.size());
  for (std::size_t i = 0; i < t.size(); ++i) {
    EXPECT_NEAR(hits[i].t, t[i], 1e-6f * std::abs(t[i]));
    EXPECT_EQ(hits[i].v, i % 2 == 0 ? -1 : 1);
  }
}

PlaneOutline square(double x, double z, double half) {
  return {{x - half, z - half}, {x + half, z - half}, {x + half, z + half}, {x - half, z + half}};
}

/// What two outlines surround is outside.
TEST(Prisms, AHoleIsWhereTwoOutlinesSurround) {
  PrismShape s;
  s.outlines = {square(0, 0, 2), square(0, 0, 1)};
  expect_at(crossings(s, {-5, 0.5f, 0.25f}, {1, 0, 0}), {3, 4, 6, 7});
  expect_at(crossings(s, {1.5f, 3, 0}, {0, -1, 0}), {2, 3});
  EXPECT_TRUE(crossings(s, {0.5f, 3, 0}, {0, -1, 0}).empty());
  // In at the upper end, out to the hole.
  expect_at(crossings(s, {2, 1.5f, 0}, {-1, -1, 0}), {0.5f, 1});
  // Along a side, through corners, and through corners from above: two crossings or none.
  for (const float z : {2.0f, 1.0f, -1.0f, -2.0f}) {
    EXPECT_EQ(crossings(s, {-5, 0.5f, z}, {1, 0, 0}).size() % 2, 0u);
    EXPECT_EQ(crossings(s, {-5, 0.5f, z - 5}, {1, 0, 1}).size() % 2, 0u);
    EXPECT_EQ(crossings(s, {z, 3, z}, {0, -1, 0}).size() % 2, 0u);
  }
  s.open = true;
  expect_at(crossings(s, {-5, 0.5f, 0.25f}, {1, 0, 0}), {3, 4, 6, 7});
  EXPECT_TRUE(crossings(s, {1.5f, 3, 0}, {0, -1, 0}).empty());
}

/// What lies between edges that fall together is nothing, so it is not met.
TEST(Prisms, EdgesThatLieOnEachOtherAreNotThere) {
  const PlaneOutline with_hairs{{-1, -1}, {0.3, -1.1}, {0.4, -3}, {0.3, -1.1}, {1, -1},      {1, 1},
                                {3, 1.7}, {1, 1},      {-1, 1},   {-1, 0.2},   {0.5, 0.125}, {-1, 0.2}};
  const PlaneOutline plain{{-1, -1}, {0.3, -1.1}, {1, -1}, {1, 1}, {-1, 1}, {-1, 0.2}};
  for (const Sweep sweep : {Sweep::linear, Sweep::conic}) {
    PrismShape hairy, bare;
    hairy.outlines = {with_hairs}, bare.outlines = {plain};
    for (PrismShape* s : {&hairy, &bare}) s->sweep = sweep, s->from = 0.5, s->to = 2;
    std::size_t met = 0;
    for (int i = 0; i < 2000; ++i) {
      const double a = 0.1 * i;
      const Vec3f from{static_cast<float>(5 * std::cos(a)), static_cast<float>(3 * std::sin(1.7 * a)),
                       static_cast<float>(5 * std::sin(a))};
      const Vec3f to{static_cast<float>(std::sin(2.3 * a)), 1.25f,
                     static_cast<float>(1.5 * std::cos(3.1 * a))};
      const std::vector<Hit> a_hits = crossings(hairy, from, to - from),
                             b_hits = crossings(bare, from, to - from);
      ASSERT_EQ(a_hits.size(), b_hits.size()) << i;
      for (std::size_t k = 0; k < a_hits.size(); ++k) EXPECT_EQ(a_hits[k].t, b_hits[k].t) << i;
      met += a_hits.size();
    }
    EXPECT_GT(met, 500u);
  }
}

/// An edge that two outlines share lies within the solid.
/// Three sides lie on each other in part: a ray leaves, enters and leaves at one place, and what is behind it
/// stays.
TEST(Prisms, ThreeSidesInOnePlaneAreCrossedInTurn) {
  PrismShape s;
  s.outlines = {{{0.375, -0.25},
                 {0.375, 0.5},
                 {0.375, 0},
                 {0.125, 0},
                 {0.25, 0.25},
                 {0.5, -0.25},
                 {0.875, 0},
                 {0.375, 0.25}}};
  for (const bool open : {false, true}) {
    s.open = open;
    expect_at(crossings(s, {2, 0.5f, 0.2f}, {-1, 0, 0}), {1.525f, 1.625f, 1.625f, 1.625f, 1.725f, 1.775f});
    expect_at(crossings(s, {-2, 0.5f, 0.2f}, {1, 0, 0}), {2.225f, 2.275f, 2.375f, 2.375f, 2.375f, 2.475f});
    const std::vector<Hit> from_inside = crossings(s, {0.425f, 0.5f, 0.2f}, {-1, 0, 0});
    ASSERT_EQ(from_inside.size(), 5u);
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(from_inside[i].v, i % 2 == 0 ? 1 : -1);
  }
}

ExactTally verify_trial(const std::string& name, std::uint64_t trial) {
  const std::vector<std::string> names = exact_oracle_names();
  const auto form = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  return verify_exact(form, kRaysPerShape, available_isas(), trial);
}

/// Random outlines on a coarse grid of which sides lie on each other in part: where there are two, a hit is
/// allowed, though rounded to float it may lie beside them.
TEST(Prisms, SidesOnEachOtherInPart) {
  for (const std::uint64_t trial : {2903, 13154, 18649, 20418}) {
    const ExactTally tally = verify_trial("prism", trial);
    EXPECT_EQ(tally.wrong(), 0u) << tally.failure;
    EXPECT_GT(tally.touched, 0u);
  }
}

/// One of the curves runs along a line and back on it, within another outline.
TEST(Prisms, CurvesOnThemselves) {
  const ExactTally tally = verify_trial("prism_bezier", 5709);
  EXPECT_EQ(tally.wrong(), 0u) << tally.failure;
}

TEST(Prisms, OutlinesSideBySideAreOne) {
  PrismShape s;
  s.outlines = {{{-1, -1}, {0, -1}, {0, 1}, {-1, 1}}, {{0, -1}, {1, -1}, {1, 1}, {0, 1}}};
  expect_at(crossings(s, {-5, 0.5f, 0.25f}, {1, 0, 0}), {4, 6});
  expect_at(crossings(s, {0.25f, 3, 0}, {0, -1, 0}), {2, 3});
}

/// Points measured with another ray tracer, whose splines these are, and by their formulas.
TEST(Prisms, CurvesGoThroughTheirPoints) {
  PrismShape s;
  s.from = -1;
  s.curve = Curve::quadratic;
  s.outlines = {{{-1, 0.5}, {0, 0}, {1, -0.7}, {2, 1}, {0.5, 2}, {0, 0}}};
  const float quadratic[] = {-0.07969f, -0.20889f, -0.34609f, -0.49129f, -0.64449f, -0.61472f, -0.40432f};
  for (int i = 0; i < 7; ++i) {
    const auto hits = crossings(s, {0.13f + 0.2f * static_cast<float>(i), 0, -5}, {0, 0, 1});
    ASSERT_EQ(hits.size(), 2u);
    EXPECT_NEAR(hits[0].t - 5, quadratic[i], 1e-6);
  }
  s.curve = Curve::cubic;
  s.outlines = {{{0.5, 2}, {0, 0}, {1, -0.7}, {2, 1}, {0.5, 2}, {0, 0}, {1, -0.7}}};
  const float cubic[] = {-0.301875397f, -0.522336641f, -0.656222771f, -0.727360060f,
                         -0.725774305f, -0.608168493f, -0.402665593f, -0.145165103f};
  for (int i = 0; i < 8; ++i) {
    const auto hits = crossings(s, {0.13f + 0.2f * static_cast<float>(i), 0, -5}, {0, 0, 1});
    ASSERT_EQ(hits.size(), 2u);
    EXPECT_NEAR(hits[0].t - 5, cubic[i], 1e-6);
  }
  // A parabola as a cubic: z = 1 - x^2.
  s.curve = Curve::bezier;
  s.outlines = {{{-1, 0}, {-1 / 3.0, 4 / 3.0}, {1 / 3.0, 4 / 3.0}, {1, 0}}};
  expect_at(crossings(s, {0.5f, 0, -1}, {0, 0, 1}), {1, 1.75f});
  expect_at(crossings(s, {-2, 0, 0.75f}, {1, 0, 0}), {1.5f, 2.5f});
}

/// At the height y the outline is y times as large; below the tip it is turned by half a turn.
TEST(Prisms, ConesOverOutlines) {
  PrismShape s;
  s.sweep = Sweep::conic;
  s.from = -1;
  s.outlines = {{{1, 0}, {2, 0}, {1, 2}}};
  expect_at(crossings(s, {0.7f, 5, 0.3f}, {0, -1, 0}), {4.3f, 4.575f});
  expect_at(crossings(s, {-0.7f, -5, -0.3f}, {0, 1, 0}), {4.3f, 4.575f});
  expect_at(crossings(s, {0, 0.5f, 0.25f}, {1, 0, 0}), {0.5f, 0.875f});
  // Through the tip: in at one end, out at the other, unless it is beside.
  expect_at(crossings(s, {2.5f, 2, 1}, {-1.25f, -1, -0.5f}), {1, 3});
  EXPECT_TRUE(crossings(s, {1, 2, 1}, {-0.5f, -1, -0.5f}).empty());
  const auto accel = build_accel({{ExactShape{s}, {}}});
  EXPECT_TRUE(inside(*accel, Vec3f{0.75f, 0.6f, 0.3f}));
  EXPECT_TRUE(inside(*accel, Vec3f{-0.75f, -0.6f, -0.3f}));
  EXPECT_FALSE(inside(*accel, Vec3f{0.75f, -0.6f, 0.3f}));
}

/// More crossings than are listed at a time.
TEST(Prisms, ALongComb) {
  PrismShape s;
  PlaneOutline comb{{0, 0}};
  constexpr int kTeeth = 300;
  for (int i = 0; i < kTeeth; ++i) {
    const double x = 2 * i;
    comb.push_back({x + 0.5, 1}), comb.push_back({x + 1, 1}), comb.push_back({x + 1.5, 0.125});
    comb.push_back({x + 2, 0.125});
  }
  comb.push_back({2 * kTeeth, -1}), comb.push_back({0, -1});
  s.outlines = {comb};
  const auto hits = crossings(s, {-1, 0.5f, 0.5f}, {1, 0, 0});
  ASSERT_EQ(hits.size(), 2u * kTeeth);
  for (int i = 0; i < 2 * kTeeth; ++i) EXPECT_EQ(hits[i].v, i % 2 == 0 ? -1 : 1);
}

/// A circle of many corners is nearly a cylinder.
TEST(Prisms, ManyPieces) {
  constexpr int kCorners = 20000;
  PrismShape s;
  s.from = -1;
  s.outlines.resize(1);
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCorners;
    s.outlines[0].push_back({std::cos(angle), std::sin(angle)});
  }
  const auto prism = build_accel({{ExactShape{s}, {}}});
  const auto cylinder = build_accel({{ExactShape{CylinderShape{}}, {}}});
  CaseRandom random(3);
  for (int i = 0; i < 2000; ++i) {
    const Ray ray{Vec3f(normalize(random.vector()) * 3.0), 0, Vec3f(random.vector()), kInf};
    const Hit a = closest_hit(*prism, ray), b = closest_hit(*cylinder, ray);
    if (a.valid() && b.valid()) {
      EXPECT_NEAR(a.t, b.t, 2e-3f * b.t);
    }
  }
}

/// The nearest point is no farther than any of many points of the surface, and lies on it.
TEST(Prisms, NearestPoints) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    CaseRandom random(seed);
    const auto names = exact_oracle_names();
    for (std::size_t form = 0; form < names.size(); ++form) {
      if (!names[form].starts_with("prism")) continue;
      const ExactOracle oracle = draw_exact_oracle(form, random);
      const auto accel = build_accel({{oracle.shape, {}}});
      std::vector<Vec3f> surface;
      for (int i = 0; i < 200; ++i) {
        const Vec3d from = normalize(random.vector()) * 4.0, to = random.vector();
        const Ray ray{Vec3f(from), 0, Vec3f(to - from), kInf};
        if (const Hit hit = closest_hit(*accel, ray); hit.valid())
          surface.push_back(surface_interaction(*accel, ray, hit).position);
      }
      for (int i = 0; i < 20; ++i) {
        const Vec3f p(random.vector() * 1.5);
        const ClosestPoint nearest = closest_point(*accel, p);
        for (const Vec3f& q : surface) EXPECT_LE(nearest.distance, length(q - p) * (1 + 1e-5f) + 1e-5f);
        const Vec3f away = p - nearest.point;
        EXPECT_NEAR(length(away), nearest.distance, 1e-5f);
        // Nothing of the surface is nearer: what is nearer is all inside or all outside.
        if (oracle.where) continue;
        const bool within = inside(*accel, p);
        for (int k = 0; k < 40; ++k) {
          const Vec3f q = p + Vec3f(normalize(random.vector()) * (0.9999 * random.unit() * nearest.distance));
          EXPECT_EQ(inside(*accel, q), within) << names[form] << ' ' << seed;
        }
        if (nearest.distance > 1e-3f) {
          EXPECT_EQ(dot(away, nearest.normal) < 0, within) << names[form] << ' ' << seed;
        }
      }
    }
  }
}

}  // namespace
}  // namespace oktett::prisms_test
