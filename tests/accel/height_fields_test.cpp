#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/accel/all_crossings.h"
#include "tests/accel/height_field_cases.h"

namespace oktett::height_fields_test {
namespace {

using namespace height_field_cases;

using Real = long double;

void expect_at(const HeightFieldShape& shape, const Vec3f& from, const Vec3f& direction,
               std::initializer_list<double> places) {
  for (const HeightWalk walk : kWalks) {
    HeightFieldShape s = shape;
    s.walk = walk;
    const std::vector<Hit> all = all_crossings(*accel_of(s), {from, 0, direction, kInf});
    ASSERT_EQ(all.size(), places.size());
    std::size_t i = 0;
    for (const double t : places) EXPECT_FLOAT_EQ(all[i++].t, static_cast<float>(t)) << "crossing " << i;
    for (i = 1; i < all.size(); ++i) EXPECT_EQ(all[i].v, -all[i - 1].v);
  }
}

TEST(HeightFields, KnownCrossings) {
  // A hump of 1 in the middle of a 3 x 3 field that is level at 0.
  const std::vector<float> hump{0, 0, 0, 0, 1, 0, 0, 0, 0};
  const auto patch = height_field(3, 3, hump, Interpolation::bilinear);
  const auto faces = height_field(3, 3, hump, Interpolation::triangles);
  const auto steps = height_field(3, 3, hump, Interpolation::nearest);
  // From above: (1 - |x|) (1 - |z|), two triangles per cell, a quarter of the hump.
  expect_at(patch, {0.5f, 3, 0.25f}, {0, -1, 0}, {3 - 0.5 * 0.75});
  expect_at(patch, {0, 3, 0}, {0, -2, 0}, {1});
  expect_at(faces, {0.25f, 3, 0.25f}, {0, -1, 0}, {2.5});
  expect_at(faces, {-0.25f, 3, 0.5f}, {0, -1, 0}, {2.5});
  expect_at(faces, {0.75f, 3, 0.5f}, {0, -1, 0}, {3});
  expect_at(steps, {0.75f, 3, 0.5f}, {0, -1, 0}, {2.75});
  // Through the hump, and along a diagonal of it, where the patch is a parabola.
  expect_at(patch, {-2, 0.25f, 0}, {1, 0, 0}, {1.25, 2.75});
  expect_at(faces, {-2, 0.25f, 0}, {1, 0, 0}, {1.25, 2.75});
  expect_at(patch, {-2, 0.25f, -2}, {1, 0, 1}, {1.5, 2.5});
  expect_at(faces, {-2, 0.25f, -2}, {1, 0, 1}, {1.625, 2.375});
  expect_at(patch, {-2, 0.25f, 2}, {1, 0, -1}, {1.5, 2.5});
  expect_at(faces, {-2, 0.25f, 2}, {1, 0, -1}, {1.25, 2.75});
  expect_at(patch, {2, 0.25f, 2}, {-1, 0, -1}, {1.5, 2.5});
  // All four cells have the same mean, so there is one level.
  expect_at(steps, {-2, 0.125f, 0.5f}, {1, 0, 0}, {});
  expect_at(steps, {-2, 0.5f, 0.5f}, {1, -0.125f, 0}, {2});
}

/// Samples of x^2 / 8, whose differences between the neighbours of a sample are its slope x / 4: so is that
/// between them, for light; the faces themselves stay flat. Alone and in groups, moved and stretched.
TEST(HeightFields, SmoothOnesShadeAsIfTheyWereCurved) {
  std::vector<float> samples;
  for (int row = 0; row < 3; ++row)
    for (int i = -4; i <= 4; ++i) samples.push_back(static_cast<float>(i * i) / 8);
  for (const Interpolation interpolation : {Interpolation::triangles, Interpolation::bilinear})
    for (const double stretch : {1.0, 2.5}) {
      HeightFieldShape shape = height_field(9, 3, samples, interpolation);
      shape.smooth = true;
      const auto accel = build_accel(
          {{ExactShape{shape}, Affine::translation({0, 1, 0}) * Affine::scaling({stretch, 1, 1})}});
      RayBatch rays;
      for (int i = 0; i < 16; ++i)
        rays.push_back({{static_cast<float>((-2.9 + 0.37 * i) * stretch), 20, 0.3f}, 0, {0, -1, 0}, kInf});
      HitBatch hits;
      hits.resize_uninitialized(rays.size());
      closest_hit(*accel, rays.span(), hits.span());
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const double x = (-2.9 + 0.37 * static_cast<double>(i)) * stretch;
        const SurfaceInteraction s = surface_interaction(*accel, rays[i], hits[i]);
        const Vec3d wanted = normalize(Vec3d{-x / (4 * stretch * stretch), 1, 0});
        EXPECT_LT(length(Vec3d(s.shading_normal) - wanted), 1e-6) << i;
        EXPECT_GT(length(s.shading_normal - s.geometric_normal), 1e-4f) << i;
      }
    }
}

TEST(HeightFields, StepsHaveWalls) {
  const auto steps = height_field(4, 2, {0, 0, 8, 8, 0, 0, 8, 8}, Interpolation::nearest);
  // Levels 0, 4 and 8.
  expect_at(steps, {-3, 1, 0}, {1, 0, 0}, {2.5});
  expect_at(steps, {-3, 5, 0}, {1, 0, 0}, {3.5});
  expect_at(steps, {3, 5, 0}, {-1, 0, 0}, {2.5});
  // Out of the highest step, which has no wall at the border; onto it and out of its wall, and so the next
  // one.
  expect_at(steps, {3, 7.5f, 0}, {-2, -1, 0}, {1.25});
  expect_at(steps, {3.5f, 14, 0}, {-3, -8, 0}, {0.75, 1, 1.25, 4.0 / 3});
  expect_at(solid(steps, -1), {-3, 1, 0}, {1, 0, 0}, {2.5, 4.5});
  const auto accel = accel_of(steps);
  const auto normal = [&](const Vec3f& from, const Vec3f& d) {
    const Ray ray{from, 0, d, kInf};
    return surface_interaction(*accel, ray, all_crossings(*accel, ray).at(0)).geometric_normal;
  };
  EXPECT_EQ(normal({-3, 1, 0}, {1, 0, 0}), (Vec3f{-1, 0, 0}));
  EXPECT_EQ(normal({3, 5, 0}, {-1, 0, 0}), (Vec3f{-1, 0, 0}));
  EXPECT_EQ(normal({0, 9, 0}, {0, -1, 0}), (Vec3f{0, 1, 0}));
}

TEST(HeightFields, SolidsHaveSidesAndABottom) {
  for (const Interpolation interpolation : kAll) {
    const auto s = solid(height_field(3, 2, {1, 1, 1, 1, 1, 1}, interpolation), -1);
    expect_at(s, {0.25f, 3, 0.25f}, {0, -1, 0}, {2, 4});
    expect_at(s, {-3, 0, 0.25f}, {1, 0, 0}, {2, 4});
    expect_at(s, {0.5f, 0, -3}, {0, 0, 1}, {2.5, 3.5});
    expect_at(s, {-3, 0, 0}, {2, 0, 0}, {1, 2});
    // From inside.
    expect_at(s, {0.25f, 0, 0.25f}, {0, 1, 0}, {1});
    expect_at(s, {0.25f, 0, 0.25f}, {0, -1, 0}, {1});
    expect_at(s, {0.25f, 0, 0.25f}, {1, 0, 0}, {0.75});
    expect_at(s, {-3, 1.5f, 0}, {1, 0, 0}, {});
    expect_at(s, {-3, 2, 0}, {2, -1, 0}, {1, 2});
    expect_at(s, {-3, -2, 0}, {2, 1, 0}, {1, 2});
  }
}

/// Where a ray meets the field, cell by cell: solves the equation of the patch in long double and keeps
/// solutions inside of the cell. `near` are crossings so close to the border of a cell that either cell may
/// report them, or neither.
struct ByCell {
  std::vector<Real> sure, near;

  ByCell(const HeightFieldShape& s, const Ray& ray) : grid_(*s.grid) {
    const Real columns = grid_.columns() - 1.0L, rows = grid_.rows() - 1.0L;
    o_ = {Real(ray.origin.x) + columns / 2, ray.origin.y, Real(ray.origin.z) + rows / 2};
    d_ = {ray.direction.x, ray.direction.y, ray.direction.z};
    for (std::uint32_t j = 0; j + 1 < grid_.rows(); ++j)
      for (std::uint32_t i = 0; i + 1 < grid_.columns(); ++i) cell(i, j);
    std::sort(sure.begin(), sure.end());
  }

 private:
  Real at(std::uint32_t i, std::uint32_t j) const { return grid_.at(i, j); }
  Real mean(std::uint32_t i, std::uint32_t j) const {
    return (at(i, j) + at(i + 1, j) + at(i, j + 1) + at(i + 1, j + 1)) / 4;
  }
  /// A crossing at t, which counts where all of `inside` are positive.
  void add(Real t, std::initializer_list<Real> inside) {
    if (!(t > 0) || !std::isfinite(t)) return;
    Real least = HUGE_VALL;
    for (const Real x : inside) least = std::min(least, x);
    if (least > 1e-9L) sure.push_back(t);
    if (std::abs(least) <= 1e-9L) near.push_back(t);
  }
  void cell(std::uint32_t i, std::uint32_t j) {
    const Real a = at(i, j), b = at(i + 1, j), c = at(i, j + 1), d = at(i + 1, j + 1);
    const Real x = o_.x - i, z = o_.z - j;
    const auto u = [&](Real t) { return x + t * d_.x; };
    const auto v = [&](Real t) { return z + t * d_.z; };
    switch (grid_.interpolation()) {
      case Interpolation::nearest: {
        const Real t = (mean(i, j) - o_.y) / d_.y;
        add(t, {u(t), 1 - u(t), v(t), 1 - v(t)});
        if (i > 0) wall(-x / d_.x, mean(i - 1, j), mean(i, j), v);
        if (j > 0) wall(-z / d_.z, mean(i, j - 1), mean(i, j), u);
        break;
      }
      case Interpolation::triangles: {
        Real t = (a + (b - a) * x + (c - a) * z - o_.y) / (d_.y - (b - a) * d_.x - (c - a) * d_.z);
        add(t, {u(t), v(t), 1 - u(t) - v(t)});
        t = (d + (d - c) * (x - 1) + (d - b) * (z - 1) - o_.y) / (d_.y - (d - c) * d_.x - (d - b) * d_.z);
        add(t, {1 - u(t), 1 - v(t), u(t) + v(t) - 1});
        break;
      }
      case Interpolation::bilinear: {
        const Real twist = a + d - b - c, by_x = b - a, by_z = c - a;
        const Real qa = twist * d_.x * d_.z;
        const Real qb = by_x * d_.x + by_z * d_.z + twist * (x * d_.z + z * d_.x) - d_.y;
        const Real qc = a + by_x * x + by_z * z + twist * x * z - o_.y;
        if (std::abs(qa) < 1e-18L * std::abs(qb)) {
          const Real t = -qc / qb;
          add(t, {u(t), 1 - u(t), v(t), 1 - v(t)});
          break;
        }
        const Real square = qb * qb - 4 * qa * qc;
        if (square < 0) break;
        const Real q = -(qb + std::copysign(std::sqrt(square), qb)) / 2;
        for (const Real t : {q / qa, qc / q})
          // A ray that all but touches may be taken to miss.
          add(t, {u(t), 1 - u(t), v(t), 1 - v(t), square < 1e-12L * qb * qb ? Real(0) : Real(1)});
        break;
      }
    }
  }
  template <class Along>
  void wall(Real t, Real before, Real here, Along&& along) {
    const Real y = o_.y + t * d_.y;
    add(t, {along(t), 1 - along(t), y - std::min(before, here), std::max(before, here) - y});
  }

  const HeightGrid& grid_;
  Vec3<Real> o_, d_;
};

bool is_among(Real t, const std::vector<Real>& list) {
  return std::any_of(list.begin(), list.end(), [&](Real x) { return std::abs(x - t) <= 1e-6L * (1 + x); });
}

/// Random rays, rays in rows and columns, and rays with components that are zero.
TEST(HeightFields, AgreesWithEveryCellOnItsOwn) {
  std::uint32_t key = 0;
  for (const Interpolation interpolation : kAll)
    for (const auto& [columns, rows] : {std::pair{2u, 2u}, {5u, 3u}, {9u, 20u}, {33u, 33u}})
      for (const float height : {0.5f, 3.0f}) {
        const auto s = rough(columns, rows, interpolation, height);
        const auto accel = accel_of(s);
        int met = 0;
        for (int n = 0; n < 300; ++n) {
          const Vec3f half{columns / 2.0f, height, rows / 2.0f};
          Vec3f from = random_point(++key, half * 1.5f);
          const Vec3f at = random_point(++key, half);
          if (n % 2 == 0) from.y += 2;
          Vec3f d = at - from;
          if (n % 5 == 1) d.x = 0;
          if (n % 7 == 2) d.z = 0;
          if (n % 11 == 3) d.y = 0;
          const Ray ray{from, 0, d, kInf};
          const std::vector<Hit> found = all_crossings(*accel, ray);
          const ByCell expected(s, ray);
          std::vector<Real> places;
          for (const Hit& h : found) {
            places.push_back(h.t);
            EXPECT_TRUE(is_among(h.t, expected.sure) || is_among(h.t, expected.near)) << n << " at " << h.t;
          }
          for (const Real t : expected.sure) EXPECT_TRUE(is_among(t, places)) << n << " at " << double(t);
          met += !found.empty();
        }
        EXPECT_GT(met, 40);
      }
}

/// Along the diagonal of a chequerboard of steps a ray meets two walls at one t in each corner. The list
/// contains both, even where a full list is continued between them.
TEST(HeightFields, CornersOfStepsAreCrossedTwice) {
  constexpr int n = 41;
  std::vector<float> heights;
  // Means of 2 and 0 in turn.
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      heights.push_back(static_cast<float>(1 + 4 * i * j * ((i + j) % 2 == 0 ? 1 : -1)));
  const HeightFieldShape steps = height_field(n, n, heights, Interpolation::nearest);
  for (const bool closed : {false, true})
    for (const HeightWalk walk : kWalks) {
      HeightFieldShape s = closed ? solid(steps, -1e4) : steps;
      s.walk = walk;
      // Onto a step at x = -9.8, then through 29 corners.
      const auto hits = all_crossings(*accel_of(s), {{-30, 3.01f, -30}, 0, {1, -0.05f, 1}, kInf});
      ASSERT_EQ(hits.size(), closed ? 60u : 59u);
      for (std::size_t i = 1; i < hits.size(); ++i) EXPECT_EQ(hits[i].v, -hits[i - 1].v) << i;
      for (std::size_t i = 1; i < 59; ++i) EXPECT_EQ(hits[i].t, 21.0f + static_cast<float>((i - 1) / 2));
    }
}

/// Normals agree with central differences and point outwards; uv is that of an image seen from above.
TEST(HeightFields, SurfacesHaveNormalsAndCoordinates) {
  for (const Interpolation interpolation : {Interpolation::triangles, Interpolation::bilinear}) {
    const auto s = rough(8, 6, interpolation);
    const Affine place = Affine::rotation({10, 20, 30}) * Affine::scaling({1, 2, 0.5});
    const auto exact = build_accel({{ExactShape{s}, place}});
    const auto central = build_accel({{ExactShape{s, NormalMethod::central}, place}});
    int smooth = 0, hits = 0;
    for (std::uint32_t i = 0; i < 100; ++i) {
      const Vec3f p = random_point(i, {3, 1, 2});
      const Ray ray{Vec3f(place.point({p.x, 9, p.z})), 0, Vec3f(place.vector({0, -1, 0})), kInf};
      for (const Hit& h : all_crossings(*exact, ray)) {
        const SurfaceInteraction a = surface_interaction(*exact, ray, h),
                                 b = surface_interaction(*central, ray, h);
        EXPECT_NEAR(length(a.geometric_normal), 1, 1e-6);
        EXPECT_GT(dot(a.geometric_normal, Vec3f(place.vector({0, 1, 0}))), 0);
        EXPECT_NEAR(a.uv.x, (p.x + 3.5) / 7, 1e-5);
        EXPECT_NEAR(a.uv.y, (2.5 - p.z) / 5, 1e-5);
        EXPECT_NEAR(dot(normalize(a.tangent), a.geometric_normal), 0, 1e-5);
        ++hits, smooth += length(a.geometric_normal - b.geometric_normal) < 1e-4f;
      }
    }
    EXPECT_EQ(hits, 100);
    EXPECT_GE(smooth, hits - 2);
  }
}

/// Solids take part in combinations: a hill less a ball, and a hill within a slab.
TEST(HeightFields, SolidsAreCombined) {
  for (const Interpolation interpolation : kAll) {
    const auto level = solid(height_field(3, 3, std::vector<float>(9, 1.0f), interpolation), -1);
    const Geometry hill{ExactShape{level}, {}, 0};
    const auto combined = [&](CsgOp op, Geometry other) {
      auto e = std::make_shared<CsgExpression>();
      e->op = op;
      e->children = {{CsgOp::operand, {hill}, {}}, {CsgOp::operand, {std::move(other)}, {}}};
      return build_accel({{CsgGeometry{std::move(e)}, {}, kNoId}});
    };
    const auto distances = [&](const Accel& accel, const Vec3f& from, const Vec3f& d) {
      std::vector<float> t;
      for (const Hit& h : all_crossings(accel, {from, 0, d, kInf})) t.push_back(h.t);
      return t;
    };
    const auto drilled = combined(CsgOp::subtract, {SpheresShape{{{{0, 1, 0}, 0.5}}}, {}, 1});
    EXPECT_EQ(distances(*drilled, {0, 3, 0}, {0, -1, 0}), (std::vector<float>{2.5f, 4}));
    EXPECT_EQ(distances(*drilled, {-3, 0.75f, 0}, {1, 0, 0}).size(), 4u);
    EXPECT_EQ(distances(*drilled, {0.75f, 3, 0}, {0, -1, 0}), (std::vector<float>{2, 4}));
    const auto slab = combined(CsgOp::intersect, {BoxShape{{-0.5, -3, -3}, {0.5, 3, 3}}, {}, 1});
    EXPECT_EQ(distances(*slab, {-3, 0, 0}, {1, 0, 0}), (std::vector<float>{2.5f, 3.5f}));
    EXPECT_EQ(distances(*slab, {0.25f, 3, 0.25f}, {0, -1, 0}), (std::vector<float>{2, 4}));
    EXPECT_EQ(distances(*slab, {0.75f, 3, 0.25f}, {0, -1, 0}), std::vector<float>{});
  }
}

TEST(HeightFields, WordsAreSixtyFiveThousandthsOfTheHeight) {
  Column<std::uint16_t> words(4);
  words[0] = words[2] = 0, words[1] = words[3] = 65535;
  HeightFieldShape s;
  s.grid = HeightGrid::from_words(2, 2, std::move(words), Interpolation::bilinear);
  s.size = {2, 3, 2};
  expect_at(s, {0.5f, 5, 0}, {0, -1, 0}, {5 - 0.75 * 3});
  expect_at(s, {-1, 5, 0.25f}, {0, -1, 0}, {5});
}

TEST(HeightFields, SenselessOnesHaveNoSurface) {
  std::vector<HeightFieldShape> bad(7,
                                    height_field(3, 3, {0, 0, 0, 0, 1, 0, 0, 0, 0}, Interpolation::bilinear));
  bad[0].grid = nullptr, bad[1].size.x = 0, bad[2].size.z = -1, bad[3].size.y = kNan, bad[4].size.y = 0;
  bad[5] = solid(bad[5], 0);
  bad[6] = height_field(1, 3, {0, 1, 0}, Interpolation::bilinear), bad[6].size = {1, 1, 1};
  for (std::size_t i = 0; i < bad.size(); ++i)
    EXPECT_TRUE(all_crossings(ExactForm{bad[i]}, {{0, 3, 0.1f}, 0, {0, -1, 0}, kInf}).empty()) << i;
}

}  // namespace
}  // namespace oktett::height_fields_test
