#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "accel/build/spatial.h"
#include "verify/cases/kernel_cases.h"

namespace oktett::spatial_test {
namespace {

/// Triangles by their corners.
class Soup final : public TriangleCorners {
 public:
  void add(const Vec3f& a, const Vec3f& b, const Vec3f& c, TriangleTest test = TriangleTest::watertight) {
    Box box;
    for (const Vec3f& p : {a, b, c}) corners_.push_back(p), box.grow(p);
    const auto item = static_cast<std::uint32_t>(refs.size());
    refs.push_back({{-box.lo.x, -box.lo.y, -box.lo.z},
                    item,
                    {box.hi.x, box.hi.y, box.hi.z},
                    static_cast<std::uint32_t>(Kind::triangle) | static_cast<std::uint32_t>(test) << 8});
    bounds.grow(box);
  }
  void corners(std::uint32_t item, Vec3f (&v)[3]) const override { std::copy_n(&corners_[3 * item], 3, v); }
  std::vector<PrimRef> refs;
  Box bounds;

 private:
  std::vector<Vec3f> corners_;
};

Box box_of(const PrimRef& r) {
  return {{-r.negative_lo[0], -r.negative_lo[1], -r.negative_lo[2]}, {r.hi[0], r.hi[1], r.hi[2]}};
}

Soup random_soup(int count, double scale, const Vec3d& middle, std::uint64_t seed) {
  Soup soup;
  CaseRandom r(seed);
  for (int i = 0; i < count; ++i) {
    const Vec3d c = r.vector();
    const auto corner = [&] { return Vec3f(middle + (c + r.vector() * 0.5) * scale); };
    const Vec3f a = corner(), b = corner();
    soup.add(a, b, corner());
  }
  return soup;
}

struct Sides {
  SpatialSplit split;
  std::vector<PrimRef> left, right;
};

Sides split(const Soup& soup, std::size_t room, bool every_axis = true, bool parallel = false) {
  const std::size_t n = soup.refs.size();
  Sides s;
  s.split = find_spatial(soup.refs.data(), n, soup.bounds, soup, {every_axis, 1, parallel});
  if (s.split.axis < 0) return s;
  std::vector<PrimRef> to(room);
  const SpatialParts parts =
      partition_spatial(soup.refs.data(), n, room, s.split, soup, parallel, to.data(), to.data() + room);
  s.left.assign(to.begin(), to.begin() + static_cast<std::ptrdiff_t>(parts.left));
  s.right.assign(to.end() - static_cast<std::ptrdiff_t>(parts.right), to.end());
  return s;
}

// Far-away, huge and tiny scenes round the crossings of edges with the plane.
TEST(Spatial, PartsCoverTheirTriangles) {
  int splits = 0;
  for (const double scale : {1.0, 1e30, 1e-20, 1e-38})
    for (const Vec3d& middle : {Vec3d{0, 0, 0}, Vec3d{3e4, -1e6, 70} * scale}) {
      const Soup soup = random_soup(200, scale, middle, 3);
      const Sides s = split(soup, 400);
      if (s.left.empty()) continue;
      ++splits;
      std::map<std::uint32_t, std::vector<Box>> parts;
      for (const PrimRef& r : s.left) parts[r.item].push_back(box_of(r));
      for (const PrimRef& r : s.right) parts[r.item].push_back(box_of(r));
      const double tolerance = 1e-15 * (length(middle) + scale);
      CaseRandom r(9);
      ASSERT_EQ(parts.size(), soup.refs.size());
      for (const auto& [item, boxes] : parts) {
        Vec3f v[3];
        soup.corners(item, v);
        for (const Box& b : boxes) EXPECT_TRUE(box_of(soup.refs[item]).contains(b));
        for (int k = 0; k < 200; ++k) {
          double a = r.unit(), b = r.unit();
          if (k % 2 != 0) b = 0;  // an edge
          if (a + b > 1) a = 1 - a, b = 1 - b;
          const Vec3d p =
              Vec3d(v[k % 3]) * (1 - a - b) + Vec3d(v[(k + 1) % 3]) * a + Vec3d(v[(k + 2) % 3]) * b;
          EXPECT_TRUE(std::any_of(boxes.begin(), boxes.end(),
                                  [&](const Box& box) {
                                    bool in = true;
                                    for (int c = 0; c < 3; ++c)
                                      in &= box.lo[c] - tolerance <= p[c] && p[c] <= box.hi[c] + tolerance;
                                    return in;
                                  }))
              << "triangle " << item << " at scale " << scale;
        }
      }
    }
  EXPECT_GE(splits, 4);  // of 8 soups
}

TEST(Spatial, PartsEndAtThePlaneOrAreWhole) {
  const Soup soup = random_soup(300, 1, {}, 4);
  const Sides s = split(soup, 600);
  ASSERT_GT(s.left.size() + s.right.size(), soup.refs.size());
  const int axis = s.split.axis;
  for (const PrimRef& r : s.left)
    EXPECT_TRUE(box_of(r).hi[axis] <= s.split.place || box_of(r) == box_of(soup.refs[r.item]));
  for (const PrimRef& r : s.right)
    EXPECT_TRUE(box_of(r).lo[axis] >= s.split.place || box_of(r) == box_of(soup.refs[r.item]));
}

// Slanted sticks from one heap of small triangles to another: their boxes hold all of the scene.
TEST(Spatial, CostIsThatOfTheParts) {
  Soup soup;
  for (int i = 0; i < 16; ++i) {
    const float y = static_cast<float>(i) * 0.01f;
    soup.add({0, y, 0}, {16, y + 0.001f, 16}, {16, y + 0.001f, 16.01f});
    const float end = i % 2 == 0 ? 0.0f : 16.0f;
    soup.add({end, y, end}, {end, y + 0.01f, end}, {end, y, end + 0.01f});
  }
  const Sides s = split(soup, 64);
  ASSERT_GE(s.split.axis, 0);
  // Of 32 in four blocks, 24 in three blocks on either side, each a quarter of the area.
  EXPECT_LT(s.split.cost, 0.45 * 4 * half_area(soup.bounds));
  Box sides[2];
  for (const PrimRef& r : s.left) sides[0].grow(box_of(r));
  for (const PrimRef& r : s.right) sides[1].grow(box_of(r));
  for (int k = 0; k < 2; ++k)
    EXPECT_NEAR(half_area(sides[k]), half_area(s.split.side[k]), 1e-3 * half_area(soup.bounds));
}

TEST(Spatial, KeepsToTheRoom) {
  const Soup soup = random_soup(300, 1, {}, 5);
  const Sides all = split(soup, 600);
  const std::size_t needed = all.left.size() + all.right.size();
  ASSERT_GT(needed, soup.refs.size());
  EXPECT_EQ(split(soup, needed).left.size(), all.left.size());
  EXPECT_TRUE(split(soup, needed - 1).left.empty());
}

// Other tests may answer differently for the same triangle in another block, and shapes have no corners.
TEST(Spatial, OnlyWatertightTrianglesAreCut) {
  Soup soup;
  CaseRandom r(6);
  for (int i = 0; i < 100; ++i)
    soup.add(Vec3f(r.vector()), Vec3f(r.vector()), Vec3f(r.vector()), TriangleTest::badouel);
  const Sides s = split(soup, 200);
  for (const std::vector<PrimRef>* side : {&s.left, &s.right})
    for (const PrimRef& ref : *side) EXPECT_EQ(box_of(ref), box_of(soup.refs[ref.item]));
  EXPECT_TRUE(s.left.empty() || s.left.size() + s.right.size() == 100);
}

TEST(Spatial, SameForAnyNumberOfTasks) {
  const Soup soup = random_soup(20000, 1, {}, 7);
  for (const std::size_t every : {1u, 5u}) {
    const SpatialSplit a = find_spatial(soup.refs.data(), soup.refs.size(), soup.bounds, soup,
                                        {true, every, false}),
                       b = find_spatial(soup.refs.data(), soup.refs.size(), soup.bounds, soup,
                                        {true, every, true});
    ASSERT_GE(a.axis, 0);
    EXPECT_EQ(a.axis, b.axis);
    EXPECT_EQ(a.place, b.place);
    EXPECT_EQ(a.cost, b.cost);
    EXPECT_EQ(a.count[0], b.count[0]);
  }
  const Sides one = split(soup, 40000), several = split(soup, 40000, true, true);
  ASSERT_GT(one.left.size() + one.right.size(), soup.refs.size());
  const auto same = [](const std::vector<PrimRef>& a, const std::vector<PrimRef>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(a[i].item, b[i].item);
      ASSERT_EQ(box_of(a[i]), box_of(b[i]));
    }
  };
  same(one.left, several.left), same(one.right, several.right);
}

// A plane found by a sample costs about as much as that found by all.
TEST(Spatial, SamplesFindGoodPlanes) {
  for (const std::uint64_t seed : {10u, 11u, 12u}) {
    const Soup soup = random_soup(30000, 1, {}, seed);
    const auto search = [&](std::size_t every) {
      return find_spatial(soup.refs.data(), soup.refs.size(), soup.bounds, soup, {true, every, false});
    };
    const SpatialSplit all = search(1), some = search(29);
    ASSERT_GE(some.axis, 0);
    EXPECT_NEAR(some.cost, all.cost, 0.1 * all.cost);
    EXPECT_NEAR(some.count[0] + some.count[1], all.count[0] + all.count[1],
                0.05 * (all.count[0] + all.count[1]));
  }
}

TEST(Spatial, OneAxisIsTheLongest) {
  CaseRandom r(9);
  for (int axis = 0; axis < 3; ++axis) {
    Soup soup;
    const auto corner = [&] {
      Vec3f p(r.vector());
      p[axis] *= 5;
      return p;
    };
    for (int i = 0; i < 50; ++i) {
      const Vec3f a = corner(), b = corner();
      soup.add(a, b, corner());
    }
    EXPECT_EQ(split(soup, 100, false).split.axis, axis);
  }
}

TEST(Spatial, WhatCannotBeSplitIsLeft) {
  constexpr float kHuge = std::numeric_limits<float>::max();
  Soup point, flat, huge;
  for (int i = 0; i < 20; ++i) {
    point.add({1, 1, 1}, {1, 1, 1}, {1, 1, 1});
    flat.add({1, 0, 0}, {1, 1, 0}, {1, 0, 1});
    huge.add({-kHuge, -kHuge, -kHuge}, {kHuge, 0, 0}, {kHuge, kHuge, kHuge});
  }
  EXPECT_LT(split(point, 40).split.axis, 0);
  EXPECT_NE(split(flat, 40).split.axis, 0);
  EXPECT_LT(split(huge, 40).split.axis, 0);
}

}  // namespace
}  // namespace oktett::spatial_test
