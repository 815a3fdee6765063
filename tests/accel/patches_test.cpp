/// \file Bezier patches against values that are known, and against triangles in long double.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "kernels/exact/march.h"
#include "tests/accel/all_crossings.h"
#include "verify/cases/kernel_cases.h"

namespace oktett::patches_test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
using Real = long double;

/// Control points (i, j) that are places(i, j).
template <class Places>
BezierPatchPoints patch_of(const Places& places) {
  BezierPatchPoints patch;
  for (int k = 0; k < 16; ++k) patch.p[k] = places(k % 4, k / 4);
  return patch;
}

Ray towards(const Vec3d& from, const Vec3d& to) {
  return {Vec3f(from), 0, Vec3f(Vec3d(Vec3f(to)) - Vec3d(Vec3f(from))), kInf};
}

std::shared_ptr<const Accel> accel_of(const ExactForm& form, const Affine& map = {}) {
  return build_accel({{ExactShape{form}, map}});
}

/// A height of x and y of the degree 3 in each, as control points over the unit square.
BezierPatchShape saddle() {
  BezierPatchShape s;
  s.patches.push_back(patch_of([](int i, int j) {
    return Vec3d{i / 3.0, j / 3.0, 0.3 * (i == 1 || i == 2) - 0.4 * (j == 1) + 0.2 * (i * j == 4)};
  }));
  return s;
}

Vec3d point_of(const BezierPatchPoints& patch, double u, double v) {
  const auto between = [](const std::array<Vec3d, 4>& p, double t) {
    std::array<Vec3d, 4> q = p;
    for (int n = 3; n > 0; --n)
      for (int k = 0; k < n; ++k) {
        const auto at = static_cast<std::size_t>(k);
        q[at] = q[at] * (1 - t) + q[at + 1] * t;
      }
    return q[0];
  };
  std::array<Vec3d, 4> rows;
  for (std::size_t j = 0; j < 4; ++j)
    rows[j] = between({patch.p[4 * j], patch.p[4 * j + 1], patch.p[4 * j + 2], patch.p[4 * j + 3]}, u);
  return between(rows, v);
}

TEST(Patches, HitsHaveTheParametersOfTheirPoint) {
  BezierPatchShape s = saddle();
  const auto accel = accel_of(s);
  for (double u = 0.03; u < 1; u += 0.094)
    for (double v = 0.01; v < 1; v += 0.0831) {
      const Vec3d p = point_of(s.patches[0], u, v);
      const Ray ray = towards({0.4, 0.3, 3}, p);
      const std::vector<Hit> hits = all_crossings(*accel, ray);
      ASSERT_FALSE(hits.empty()) << u << " " << v;
      bool found = false;
      for (const Hit& hit : hits) {
        const SurfaceInteraction at = surface_interaction(*accel, ray, hit);
        if (std::abs(at.uv.x - u) > 1e-5 || std::abs(at.uv.y - v) > 1e-5) continue;
        found = true;
        constexpr double h = 1e-4;
        const Vec3d by_u = (point_of(s.patches[0], u + h, v) - point_of(s.patches[0], u - h, v)) / (2 * h);
        const Vec3d by_v = (point_of(s.patches[0], u, v + h) - point_of(s.patches[0], u, v - h)) / (2 * h);
        EXPECT_LT(length(Vec3d(at.tangent) - by_u), 1e-4);
        EXPECT_LT(length(Vec3d(at.bitangent) - by_v), 1e-4);
        EXPECT_LT(length(Vec3d(at.geometric_normal) - normalize(cross(by_u, by_v))), 1e-4);
        EXPECT_LT(length(Vec3d(at.position) - p), 1e-5);
        // The ray enters what is behind the front.
        EXPECT_EQ(hit.v, dot(ray.direction, at.geometric_normal) < 0 ? -1 : 1);
      }
      EXPECT_TRUE(found) << u << " " << v;
    }
}

TEST(Patches, TextureCoordinatesAreBilinearBetweenTheCorners) {
  BezierPatchShape s;
  s.patches.push_back(patch_of([](int i, int j) { return Vec3d{i / 3.0, j / 3.0, 0}; }));
  const double uv[8] = {0.1, 0.2, 0.9, 0.3, 0.8, 0.95, 0.15, 0.75};
  std::copy(std::begin(uv), std::end(uv), s.uv);
  const auto accel = accel_of(s);
  const auto at = [&](double x, double y) {
    const Ray ray = towards({x, y, 2}, {x, y, 0});
    return surface_interaction(*accel, ray, closest_hit(*accel, ray));
  };
  const SurfaceInteraction low = at(0.25, 0.5), high = at(0.75, 0.5);
  EXPECT_NEAR(low.uv.x, 0.75 * 0.125 + 0.25 * 0.85, 1e-6);
  EXPECT_NEAR(low.uv.y, 0.75 * 0.475 + 0.25 * 0.625, 1e-6);
  EXPECT_NEAR(high.uv.x, 0.25 * 0.125 + 0.75 * 0.85, 1e-6);
  // The derivatives take a step of texture coordinates to the plane.
  const double du = high.uv.x - low.uv.x, dv = high.uv.y - low.uv.y;
  const Vec3d step = Vec3d(at(0.5, 0.5).tangent) * du + Vec3d(at(0.5, 0.5).bitangent) * dv;
  EXPECT_LT(length(step - Vec3d{0.5, 0, 0}), 1e-6);
}

/// A sheet of many patches, and rays at its edges and corners from both sides.
TEST(Patches, NoRayPassesBetweenNeighbours) {
  CaseRandom random(31);
  constexpr int kSide = 3;
  for (const double size : {1e-3, 1.0, 1e3})
    for (const bool far : {false, true}) {
      std::vector<Vec3d> points;
      for (int k = 0; k < (3 * kSide + 1) * (3 * kSide + 1); ++k)
        points.push_back(Vec3d{k % (3 * kSide + 1) + 0.2 * random.sign(),
                               k / (3 * kSide + 1) + 0.2 * random.sign(), 0.8 * random.sign()});
      BezierPatchShape s;
      for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i)
          s.patches.push_back(patch_of([&](int x, int y) {
            return points[static_cast<std::size_t>(3 * i + x + (3 * j + y) * (3 * kSide + 1))] * size;
          }));
      const Vec3d offset = far ? Vec3d{300, -200, 100} * size : Vec3d{0, 0, 0};
      const auto accel = accel_of(s, Affine::translation(offset));
      int missed = 0;
      for (int n = 0; n < 4000; ++n) {
        const BezierPatchPoints& middle = s.patches[4];
        const double along = n % 5 == 0 ? 0 : random.unit();
        const Vec3d edge = n % 2 == 0 ? point_of(middle, n % 4 < 2 ? 0 : 1, along)
                                      : point_of(middle, along, n % 4 < 2 ? 0 : 1);
        const double above = (n / 4 % 2 == 0 ? 1 : -1) * size * (4 + 6 * random.unit());
        const Vec3d from = edge + Vec3d{random.sign() * size, random.sign() * size, above};
        missed += !closest_hit(*accel, towards(from + offset, edge + offset)).valid();
      }
      EXPECT_EQ(missed, 0) << size << " " << far;
    }
}

/// Eight patches around the origin with points for edges at the poles.
BezierPatchShape globe() {
  constexpr double c = 0.5522847498;
  constexpr double kRadius[7] = {0, c, 1, 1, 1, c, 0}, kHeight[7] = {-1, -1, -c, 0, c, 1, 1};
  constexpr double kX[12] = {1, 1, c, 0, -c, -1, -1, -1, -c, 0, c, 1};
  BezierPatchShape s;
  s.open = false;
  for (int half = 0; half < 2; ++half)
    for (int quarter = 0; quarter < 4; ++quarter)
      s.patches.push_back(patch_of([&](int i, int j) {
        const int around = (3 * quarter + i) % 12, up = 3 * half + j;
        return Vec3d{kRadius[up] * kX[around], kRadius[up] * kX[(around + 9) % 12], kHeight[up]};
      }));
  return s;
}

TEST(Patches, PolesAreMetOnce) {
  const BezierPatchShape s = globe();
  const auto accel = accel_of(s);
  for (const double x : {0.0, 1e-14, 1e-10, 1e-6, 1e-3}) {
    const Ray ray = towards({x, 0, 4}, {x, 0, 0});
    const std::vector<Hit> hits = all_crossings(*accel, ray);
    ASSERT_EQ(hits.size(), 2u) << x;
    EXPECT_NEAR(hits[0].t, 0.75, 1e-6);
    EXPECT_NEAR(hits[1].t, 1.25, 1e-6);
    EXPECT_EQ(hits[0].v, -1);
    EXPECT_EQ(hits[1].v, 1);
    const SurfaceInteraction at = surface_interaction(*accel, ray, hits[0]);
    EXPECT_NEAR(at.geometric_normal.z, 1, 2e-3);
    EXPECT_NEAR(length(Vec3d(at.position) - Vec3d{x, 0, 1}), 0, 1e-6);
  }
  // Through a pole at a slant, and from inside.
  CaseRandom random(5);
  RayBatch from_inside, from_outside;
  for (int n = 0; n < 500; ++n) {
    const Vec3d pole{0, 0, n % 2 == 0 ? 1.0 : -1.0};
    const Vec3d inside = random.vector() * 0.5, outside = pole * 3 + random.vector();
    from_inside.push_back(towards(inside, pole));
    from_outside.push_back(towards(outside, pole));
  }
  for (const std::vector<Hit>& hits : all_crossings(*accel, from_inside)) EXPECT_EQ(hits.size(), 1u);
  for (const std::vector<Hit>& hits : all_crossings(*accel, from_outside)) EXPECT_EQ(hits.size(), 2u);
}

/// Eight patches meet at each pole, and several have a hit at the same distance: in each way through the tree
/// the same one counts.
TEST(Patches, PolesHaveOnePieceInEachMode) {
  const auto accel = accel_of(globe());
  CaseRandom random(7);
  RayBatch rays;
  for (int n = 0; n < 512; ++n) {
    const Vec3d pole{0, 0, n % 2 == 0 ? 1.0 : -1.0};
    rays.push_back(towards(n % 4 < 2 ? Vec3d{0, 0, 5} : random.vector() * (n % 8 < 4 ? 0.5 : 4), pole));
  }
  HitBatch expected, hits;
  expected.resize_uninitialized(rays.size()), hits.resize_uninitialized(rays.size());
  closest_hit(*accel, rays.span(), expected.span(), available_isas().front(), TraceMode::single);
  for (const Isa isa : available_isas())
    for (const TraceMode mode : {TraceMode::automatic, TraceMode::single, TraceMode::interleaved,
                                 TraceMode::packet8, TraceMode::packet16, TraceMode::beam}) {
      closest_hit(*accel, rays.span(), hits.span(), isa, mode);
      int others = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) others += !(hits[i] == expected[i]);
      EXPECT_EQ(others, 0) << to_string(isa) << " " << static_cast<int>(mode);
    }
}

TEST(Patches, ASolidIsLeftAsOftenAsItIsEntered) {
  const auto accel = accel_of(globe());
  CaseRandom random(6);
  for (int n = 0; n < 3000; ++n) {
    // Directions on edges are those of the planes of coordinates.
    Vec3d d = random.vector();
    if (n % 3 < 2) d[n % 3 == 0 ? n / 3 % 3 : 2] = 0;
    const Vec3d from = n % 2 == 0 ? Vec3d{0, 0, 0} : normalize(d) * -5;
    const std::vector<Hit> hits = all_crossings(*accel, {Vec3f(from), 0, Vec3f(d), kInf});
    ASSERT_EQ(hits.size(), n % 2 == 0 ? 1u : 2u) << n;
    EXPECT_EQ(hits.back().v, 1);
    const SurfaceInteraction at = surface_interaction(*accel, {Vec3f(from), 0, Vec3f(d), kInf}, hits[0]);
    EXPECT_GT(dot(at.geometric_normal, at.position), 0.9f);
  }
}

/// The other way around the normals point outwards, too.
TEST(Patches, SolidsAreTurnedOutwards) {
  BezierPatchShape s = globe();
  for (BezierPatchPoints& patch : s.patches)
    for (int j = 0; j < 4; ++j)
      std::swap(patch.p[4 * j], patch.p[4 * j + 3]), std::swap(patch.p[4 * j + 1], patch.p[4 * j + 2]);
  const auto accel = accel_of(s);
  const Ray ray = towards({0.3, 0.2, 4}, {0.1, 0.2, 0});
  const std::vector<Hit> hits = all_crossings(*accel, ray);
  ASSERT_EQ(hits.size(), 2u);
  EXPECT_EQ(hits[0].v, -1);
  EXPECT_GT(surface_interaction(*accel, ray, hits[0]).geometric_normal.z, 0.9f);
}

TEST(Patches, RaysInAPatchDoNotCrossIt) {
  BezierPatchShape s;
  s.patches.push_back(patch_of([](int i, int j) { return Vec3d{i / 3.0, j / 3.0, 0.25}; }));
  const auto accel = accel_of(s);
  const std::uint64_t before = interval::uncertified_count();
  CaseRandom random(7);
  for (int n = 0; n < 300; ++n) {
    const Vec3d d{random.sign(), random.sign(), 0};
    EXPECT_TRUE(all_crossings(*accel, {{0.5f, 0.25f, 0.25f}, 0, Vec3f(d), kInf}).empty());
    EXPECT_TRUE(all_crossings(*accel, {{-1, 0, 0.25f}, 0, {1, 0, 0}, kInf}).empty());
  }
  EXPECT_EQ(interval::uncertified_count(), before);
}

/// Sheets behind each other that face one way are all listed.
TEST(Patches, SheetsNeedNotAlternate) {
  BezierPatchShape s;
  for (int k = 0; k < 3; ++k)
    s.patches.push_back(patch_of([k](int i, int j) { return Vec3d{i / 3.0, j / 3.0, 0.5 * k}; }));
  const std::vector<Hit> hits = all_crossings(s, towards({0.4, 0.3, 3}, {0.45, 0.35, 0}));
  ASSERT_EQ(hits.size(), 3u);
  for (const Hit& hit : hits) EXPECT_EQ(hit.v, -1);
}

/// What a line meets of a patch of many triangles: the signs of the two planes' functions at corners tell.
struct Counted {
  std::vector<Real> t;
  int turns = 0;
};
Counted count_triangles(const BezierPatchPoints& patch, const Ray& ray, int side) {
  const Vec3<Real> o(ray.origin), d(ray.direction);
  Vec3<Real> x, y;
  make_basis(normalize(d), x, y);
  struct Corner {
    Real a, b, t;
  };
  std::vector<Corner> corners;
  for (int j = 0; j <= side; ++j)
    for (int i = 0; i <= side; ++i) {
      const auto weights = [](Real t) {
        return std::array<Real, 4>{(1 - t) * (1 - t) * (1 - t), 3 * t * (1 - t) * (1 - t),
                                   3 * t * t * (1 - t), t * t * t};
      };
      const auto wu = weights(Real(i) / side), wv = weights(Real(j) / side);
      Vec3<Real> p{0, 0, 0};
      for (std::size_t k = 0; k < 16; ++k) p += Vec3<Real>(patch.p[k]) * (wu[k % 4] * wv[k / 4]);
      corners.push_back({dot(x, p - o), dot(y, p - o), dot(d, p - o) / dot(d, d)});
    }
  Counted found;
  const auto look = [&](const Corner& p, const Corner& q, const Corner& r) {
    const Real pq = p.a * q.b - p.b * q.a, qr = q.a * r.b - q.b * r.a, rp = r.a * p.b - r.b * p.a;
    const bool front = pq > 0 && qr > 0 && rp > 0, back = pq < 0 && qr < 0 && rp < 0;
    if (!front && !back) return;
    const Real t = (p.t * qr + q.t * rp + r.t * pq) / (pq + qr + rp);
    if (t > 0) found.t.push_back(t), found.turns += front ? 1 : -1;
  };
  const auto at = [&](int i, int j) -> const Corner& {
    return corners[static_cast<std::size_t>(i + j * (side + 1))];
  };
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i)
      look(at(i, j), at(i + 1, j), at(i + 1, j + 1)), look(at(i, j), at(i + 1, j + 1), at(i, j + 1));
  std::sort(found.t.begin(), found.t.end());
  return found;
}

/// Patches that cross themselves, with points for edges now and then.
TEST(Patches, WildPatchesAreMetWhereTheirTrianglesAre) {
  CaseRandom random(11);
  int compared = 0, many = 0;
  for (int n = 0; n < 28; ++n) {
    BezierPatchShape s;
    s.patches.push_back(patch_of([&](int, int) { return random.vector(); }));
    if (n % 4 == 1)
      for (int k = 1; k < 4; ++k) s.patches[0].p[k] = s.patches[0].p[0];
    if (n % 4 == 2)
      for (int k = 1; k < 4; ++k) s.patches[0].p[4 * k + 3] = s.patches[0].p[3];
    const double size = std::pow(10.0, n % 7 - 3);
    for (Vec3d& p : s.patches[0].p) p = p * size;
    const auto accel = accel_of(s);
    for (int k = 0; k < 20; ++k) {
      const Ray ray = towards(random.vector() * (2 * size), random.vector() * (0.3 * size));
      const Counted coarse = count_triangles(s.patches[0], ray, 96),
                    fine = count_triangles(s.patches[0], ray, 144);
      const std::vector<Hit> hits = all_crossings(*accel, ray);
      // Near a fold the triangles may not tell.
      if (coarse.t.size() != fine.t.size()) continue;
      Real apart = 1;
      for (std::size_t i = 0; i < fine.t.size(); ++i) {
        apart = std::min(apart, fine.t[i]);
        if (i > 0) apart = std::min(apart, fine.t[i] - fine.t[i - 1]);
      }
      if (apart < 1e-2L) continue;
      ++compared, many += hits.size() > 1;
      ASSERT_EQ(hits.size(), fine.t.size()) << n << " " << k;
      int turns = 0;
      for (std::size_t i = 0; i < hits.size(); ++i) {
        EXPECT_NEAR(hits[i].t, static_cast<double>(fine.t[i]), 4e-3);
        turns += hits[i].v > 0 ? 1 : -1;
      }
      EXPECT_EQ(turns, fine.turns);
    }
  }
  EXPECT_GT(compared, 300);
  EXPECT_GT(many, 50);
}

}  // namespace
}  // namespace oktett::patches_test
