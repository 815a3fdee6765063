#include <gtest/gtest.h>

#include <cmath>

#include "kernels/fractals/fractal_union.h"
#include "tests/accel/all_crossings.h"
#include "tests/accel/fractal_cases.h"

namespace oktett::fractal_shapes_test {
namespace {

/// Every crossing is at its place, entering and leaving in turn, except for parts thinner than rounding.
void expect_agreement(const ExactForm& form, const ConvexUnion& truth, int count, double size) {
  const auto accel = build_accel({{ExactShape{form}, {}}});
  int met = 0, index = 0;
  for (const Ray& ray : rays_about(count, size)) {
    SCOPED_TRACE(index++);
    const std::vector<Hit> hits = all_crossings(*accel, ray);
    std::vector<LineSpan> spans;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      EXPECT_EQ(hits[i].v, (hits.size() - i) % 2 == 1 ? 1 : -1) << "crossing " << i;
      if (hits[i].v > 0) spans.push_back({i > 0 ? hits[i - 1].t : -1e3L, hits[i].t});
    }
    const auto expected = sure_crossings(truth.spans(ray), 2e-5L), found = sure_crossings(spans, 2e-5L);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      EXPECT_NEAR(found[i], expected[i], 2e-6) << "crossing " << i;
    met += !hits.empty();
  }
  EXPECT_GT(met, count / 3);
}

TEST(Sphereflake, AgreesWithAllItsBalls) {
  for (const std::uint32_t depth : {0, 1, 3})
    for (const double ratio : {1.0 / 3, 0.5, 0.2})
      expect_agreement(flake(depth, ratio), explicit_balls(flake(depth, ratio)), 150, 1.5);
}

TEST(Menger, AgreesWithAllItsCubes) {
  for (const std::uint32_t depth : {0, 1, 2, 3})
    expect_agreement(sponge(depth), explicit_cubes(sponge(depth)), depth == 3 ? 80 : 250, 1.1);
}

/// Pieces of maps that scale all axes alike.
ConvexUnion explicit_pieces(const IfsShape& s) {
  std::vector<Affine> pieces{Affine{}};
  for (std::uint32_t k = 0; k < s.depth; ++k) {
    std::vector<Affine> next;
    for (const Affine& piece : pieces)
      for (const Affine& map : s.maps) next.push_back(piece * map);
    pieces = next;
  }
  ConvexUnion all;
  for (const Affine& piece : pieces) {
    const double size = std::abs(piece.m[0][0]);
    const Vec3l c(piece.point({0, 0, 0})), half(Vec3d{size, size, size});
    if (s.base == IfsShape::Base::ball)
      all.balls.push_back({c, size});
    else
      all.boxes.push_back({c - half, c + half});
  }
  return all;
}

TEST(Ifs, AgreesWithAllItsPieces) {
  for (const std::uint32_t depth : {0, 1, 2, 5})
    for (const auto base : {IfsShape::Base::ball, IfsShape::Base::box}) {
      const IfsShape s = tetrahedron(depth, base);
      expect_agreement(s, explicit_pieces(s), 120, depth < 3 ? 1.3 : 1);
    }
}

/// The sponge by its walk from cell to cell and as an iterated function system give the same hits.
TEST(Ifs, MengersSpongeByMapsIsTheSponge) {
  for (const std::uint32_t depth : {1u, 3u, 5u}) {
    const auto a = build_accel({{ExactShape{sponge_by_maps(depth)}, {}}});
    const auto b = build_accel({{ExactShape{sponge(depth)}, {}}});
    int crossings = 0;
    for (int i = 0; i < 40; ++i) {
      Numbers random{static_cast<std::uint64_t>(i)};
      const Vec3d from = random.vector() * 4, at = random.vector();
      const Ray ray{Vec3f(from), 0, Vec3f(at - from), kInf};
      const auto x = all_crossings(*a, ray), y = all_crossings(*b, ray);
      ASSERT_EQ(x.size(), y.size()) << depth << ", " << i;
      for (std::size_t k = 0; k < x.size(); ++k) EXPECT_FLOAT_EQ(x[k].t, y[k].t);
      crossings += static_cast<int>(x.size());
    }
    EXPECT_GT(crossings, 80);
  }
}

/// Barnsley's fern has a stem of almost no thickness. Its pieces soon are too thin to be divided; the leaves
/// are still divided to full depth.
TEST(Ifs, FlatMapsLeaveTheOthersTheirDepth) {
  IfsShape s;
  s.maps = {Affine::scaling({0.001, 0.16, 0.001}),
            Affine::translation({0, 0.32, 0}) * Affine::scaling({0.85, 0.85, 0.85})};
  s.depth = 32;
  // What is highest is the base after 32 of the second map: 0.32 (1 + 0.85 + ...) + 0.85^32.
  const double last = std::pow(0.85, 32), top = 0.32 * (1 - last) / 0.15 + last;
  const auto accel = build_accel({{ExactShape{s}, {}}});
  const auto hits = all_crossings(*accel, {{0, 8, 0}, 0, {0, -1, 0}, kInf});
  ASSERT_FALSE(hits.empty());
  EXPECT_NEAR(8 - hits[0].t, top, 1e-6);
  EXPECT_NEAR(bounds(*accel).hi.y, top, 0.01);
}

/// Far from the origin of the ray t is coarser than the margin of any ball.
TEST(Ifs, BallsAreLeftWhereverRaysBegin) {
  const auto accel = build_accel({{ExactShape{tetrahedron(0)}, {}}});
  Numbers random{5};
  for (int i = 0; i < 3000; ++i) {
    const Vec3d at = random.vector() * 0.5;
    const Vec3d from = at + normalize(random.vector()) * std::ldexp(1.0, i % 12);
    std::vector<Hit> hits;
    all_hits(*accel, {Vec3f(from), 0, Vec3f(at - from) * 0.5f, kInf}, hits, default_isa());
    EXPECT_EQ(hits.size(), length(Vec3d(Vec3f(from))) < 1 ? 1u : 2u) << i;
  }
}

TEST(Ifs, NormIsTheLargestStretch) {
  for (const Vec3d& s :
       {Vec3d{0.5, 0.5, 0.5}, Vec3d{0.1, 0.9, 0.3}, Vec3d{1e-6, 1e-3, -0.7}, Vec3d{3, 2, 1}}) {
    const double truth = std::max({std::abs(s.x), std::abs(s.y), std::abs(s.z)});
    const double norm =
        Ifs::norm(Affine::rotation({10, 20, 30}) * Affine::scaling(s) * Affine::rotation({50, 60, 70}));
    EXPECT_GE(norm, truth * (1 - 1e-14));
    EXPECT_LE(norm, truth * (1 + 1e-6));
  }
}

/// No point that the maps lead to is outside of the bounds.
TEST(Ifs, BoundsHoldEveryPiece) {
  for (const std::uint32_t depth : {0u, 3u, 9u, 32u}) {
    const Affine place = Affine::rotation({10, 20, 30}) * Affine::scaling({2, 1, 0.5});
    const IfsShape s = plant(depth);
    const Box box = bounds(*build_accel({{ExactShape{s}, place}}));
    Numbers random{11};
    for (int i = 0; i < 2000; ++i) {
      Affine piece = place;
      const int levels = static_cast<int>((random.next() + 1) / 2 * (depth + 1));
      for (int k = 0; k < levels; ++k)
        piece = piece * s.maps[static_cast<std::size_t>((random.next() + 1) * 1.5) % 3];
      const Vec3d p = piece.point(normalize(random.vector()));
      for (int k = 0; k < 3; ++k) {
        EXPECT_LE(box.lo[k], p[k]);
        EXPECT_GE(box.hi[k], p[k]);
      }
    }
  }
}

/// Heights level by level, every cell as two triangles.
struct ExplicitTerrain {
  explicit ExplicitTerrain(const TerrainShape& s)
      : side(1 << s.depth), base(s.base), h((side + 1) * (side + 1)) {
    double step = s.height;
    for (const int i : {0, side})
      for (const int k : {0, side}) at(i, k) = step * Terrain::displacement(s.seed, 0, i / side, k / side);
    for (int size = side, level = 1; size > 1; size /= 2, ++level) {
      step *= s.roughness;
      const int half = size / 2;
      for (int k = 0; k <= side; k += half)
        for (int i = 0; i <= side; i += half) {
          const bool odd_i = i / half % 2 == 1, odd_k = k / half % 2 == 1;
          if (!odd_i && !odd_k) continue;
          const int di = odd_i ? half : 0, dk = odd_k ? half : 0;
          at(i, k) = (at(i - di, k - dk) + at(i + di, k - dk) + at(i - di, k + dk) + at(i + di, k + dk)) / 4 +
                     step * Terrain::displacement(s.seed, level, i / half, k / half);
        }
    }
  }
  long double& at(int i, int k) { return h[k * (side + 1) + i]; }
  Vec3l corner(int i, int k) { return {2.0L * i / side - 1, at(i, k), 2.0L * k / side - 1}; }

  /// Where a line meets the triangles (Möller and Trumbore), walls and floor.
  std::vector<long double> crossings(const Ray& ray) {
    const Vec3l o(ray.origin), d(ray.direction);
    std::vector<long double> all;
    for (int k = 0; k < side; ++k)
      for (int i = 0; i < side; ++i)
        for (const int upper : {0, 1}) {
          const Vec3l a = corner(i, k), b = corner(i + 1, k + 1),
                      c = upper ? corner(i, k + 1) : corner(i + 1, k);
          const Vec3l e1 = b - a, e2 = c - a, p = cross(d, e2), s = o - a, q = cross(s, e1);
          const long double det = dot(e1, p), u = dot(s, p) / det, v = dot(d, q) / det, t = dot(e2, q) / det;
          const Vec3l at_t = o + d * t;
          if (u >= 0 && v >= 0 && u + v <= 1 && t > 0 && at_t.y > base) all.push_back(t);
        }
    for (const int axis : {0, 1, 2})
      for (const long double plane : {-1.0L, 1.0L}) {
        if (axis == 1 && plane > 0) continue;
        const long double t = ((axis == 1 ? base : plane) - o[axis]) / d[axis];
        const Vec3l p = o + d * t;
        const bool beside = (axis == 0 || std::abs(p.x) < 1) && (axis == 2 || std::abs(p.z) < 1);
        if (!(t > 0) || !beside) continue;
        const auto place = [&](long double x) { return std::min(std::max((x + 1) / 2, 0.0L), 1.0L) * side; };
        const long double x = place(p.x), z = place(p.z);
        const int i = std::min(static_cast<int>(x), side - 1), k = std::min(static_cast<int>(z), side - 1);
        const long double u = x - i, v = z - k;
        const long double height = u >= v
                                       ? at(i, k) * (1 - u) + at(i + 1, k) * (u - v) + at(i + 1, k + 1) * v
                                       : at(i, k) * (1 - v) + at(i, k + 1) * (v - u) + at(i + 1, k + 1) * u;
        if ((axis == 1 || p.y > base) && p.y < height) all.push_back(t);
      }
    std::sort(all.begin(), all.end());
    return all;
  }

  int side;
  double base;
  std::vector<long double> h;
};

TEST(Terrain, AgreesWithAllItsTriangles) {
  for (const std::uint32_t depth : {0u, 1u, 4u})
    for (const double base : {-1.0, 0.0}) {
      TerrainShape s = terrain(depth, 0.6);
      s.base = base;
      ExplicitTerrain truth(s);
      const auto accel = build_accel({{ExactShape{s}, {}}});
      int met = 0;
      for (int i = 0; i < 600; ++i) {
        Numbers random{static_cast<std::uint64_t>(i)};
        const Vec3d from = random.vector() * 2.5;
        Vec3d at = random.vector() * 0.9;
        at.y = base + 0.2 * (at.y + 0.9);
        const Ray ray{Vec3f(from), 0, Vec3f(at - from), kInf};
        const auto found = all_crossings(*accel, ray);
        const auto expected = truth.crossings(ray);
        ASSERT_EQ(found.size(), expected.size()) << depth << ", ray " << i;
        for (std::size_t k = 0; k < found.size(); ++k) {
          EXPECT_NEAR(found[k].t, expected[k], 1e-6) << i;
          EXPECT_EQ(found[k].v, (found.size() - k) % 2 == 1 ? 1 : -1);
          const SurfaceInteraction surf = surface_interaction(*accel, ray, found[k]);
          EXPECT_GE(dot(surf.geometric_normal, ray.direction) * found[k].v, 0);
        }
        met += !found.empty();
      }
      EXPECT_GT(met, 60);
    }
}

/// Straight down and aslant through corners, edges and diagonals: in once, out once.
TEST(Terrain, HasNoCracks) {
  const std::uint32_t depth = 10;
  const auto accel = build_accel({{ExactShape{terrain(depth)}, {}}});
  for (int i = 1; i < 64; ++i)
    for (int k = 1; k < 64; ++k) {
      const Vec3f at{static_cast<float>(i) / 32 - 1, 3, static_cast<float>(k) / 32 - 1};
      std::vector<Hit> hits;
      all_hits(*accel, {at, 0, {0, -1, 0}, kInf}, hits, default_isa());
      ASSERT_EQ(hits.size(), 2u) << i << ", " << k;
      EXPECT_EQ(hits[1].t, 4);
      // Along grid lines and diagonals, from above the middle to below everything.
      for (const Vec3f& d : {Vec3f{0x1p-12f, -1, 0}, Vec3f{0, -1, 0x1p-12f}, Vec3f{0x1p-12f, -1, 0x1p-12f},
                             Vec3f{-0x1p-12f, -1, 0x1p-12f}}) {
        all_hits(*accel, {at, 0, d, kInf}, hits, default_isa());
        ASSERT_GE(hits.size(), 2u);
        EXPECT_EQ(hits.size() % 2, 0u);
      }
    }
}

/// A finer terrain has all points of a coarser one.
TEST(Terrain, DepthRefines) {
  const auto coarse = build_accel({{ExactShape{terrain(4)}, {}}}),
             fine = build_accel({{ExactShape{terrain(20)}, {}}});
  for (int i = 1; i < 16; ++i) {
    const Ray ray{{static_cast<float>(i) / 8 - 1, 3, 0.25f}, 0, {0, -1, 0}, kInf};
    EXPECT_FLOAT_EQ(all_crossings(*coarse, ray)[0].t, all_crossings(*fine, ray)[0].t);
  }
}

/// Iteration at points along the ray: a point inside lies in a listed span, except near the ends of spans.
TEST(Julia, MissesNothingThatSamplesFind) {
  for (const std::uint32_t iterations : {1u, 4u, 9u, 16u}) {
    const JuliaShape s = julia(iterations);
    Julia::Pool pool;
    Julia::add(pool, s, {});
    const auto accel = build_accel({{ExactShape{s}, {}}});
    int inside = 0;
    for (int i = 0; i < 60; ++i) {
      Numbers random{static_cast<std::uint64_t>(i)};
      const Vec3d from = normalize(random.vector()) * 3, at = random.vector();
      const Ray ray{Vec3f(from), 0, Vec3f(at - from), kInf};
      const std::vector<Hit> hits = all_crossings(*accel, ray);
      for (int k = 0; k < 3000; ++k) {
        const double t = 2.0 * k / 3000;
        if (!is_inside<Julia>(pool, 0, Vec3d(ray.origin) + Vec3d(ray.direction) * t)) continue;
        ++inside;
        bool listed = false;
        for (std::size_t j = 0; j + 1 < hits.size(); j += 2)
          listed |= hits[j].t - 1e-6 <= t && t <= hits[j + 1].t + 1e-6;
        EXPECT_TRUE(listed) << iterations << ", ray " << i << " at " << t;
      }
    }
    EXPECT_GT(inside, 500);
  }
}

/// Along a diagonal all three digits are the same, so that what is left is Cantor's dust; every plane is met
/// together with two others.
TEST(Menger, TheDiagonalIsCantorsDust) {
  std::vector<std::pair<double, double>> dust{{0, 1}};
  for (std::uint32_t depth = 1; depth <= 8; ++depth) {
    std::vector<std::pair<double, double>> finer;
    for (const auto& [in, out] : dust)
      finer.push_back({in, in + (out - in) / 3}), finer.push_back({out - (out - in) / 3, out});
    dust = finer;
    // Lengths of 2 along each axis.
    const std::vector<Hit> hits = all_crossings(sponge(depth), {{-2, -2, -2}, 0, {2, 2, 2}, kInf});
    ASSERT_EQ(hits.size(), 2 * dust.size()) << depth;
    for (std::size_t i = 0; i < dust.size(); ++i) {
      EXPECT_FLOAT_EQ(hits[2 * i].t, static_cast<float>(0.5 + dust[i].first));
      EXPECT_FLOAT_EQ(hits[2 * i + 1].t, static_cast<float>(0.5 + dust[i].second));
    }
  }
}

/// Bounds leave room for points whose coordinates are off by the slack: those that the part of the world's
/// origin in a coordinate has and those that the size of the element adds.
TEST(Fractals, BoundsLeaveRoomForRounding) {
  Numbers random{17};
  constexpr double kRadius = 1.5, kSlack = 0.01;
  for (int i = 0; i < 100; ++i) {
    ExactFrame frame;
    frame.to_world = Affine::translation(random.vector() * (i % 3 == 0 ? 10.0 : 0.5)) *
                     Affine::rotation(random.vector() * 180.0) * Affine::scaling({1, 2, 0.5});
    frame.to_own = frame.to_world.inverse();
    const Box box =
        bounds_by_support(frame, kSlack, kRadius, [](const Vec3d& w) { return kRadius * length(w); });
    for (int k = 0; k < 3; ++k) {
      const auto& row = frame.to_world.m[k];
      const double reach = kRadius * std::hypot(row[0], row[1], row[2]);
      const double pad = kSlack * (std::abs(row[3]) + reach);
      EXPECT_LE(box.lo[k], row[3] - reach - pad);
      EXPECT_GE(box.hi[k], row[3] + reach + pad);
      EXPECT_NEAR(box.hi[k] - box.lo[k], 2 * (reach + pad), 1e-5 * (1 + std::abs(row[3])));
    }
  }
}

TEST(Menger, HolesAndEdgesAtAnyDepth) {
  for (std::uint32_t depth = 1; depth <= 14; ++depth) {
    SCOPED_TRACE(depth);
    for (int axis = 0; axis < 3; ++axis)
      for (const float way : {-1.0f, 1.0f}) {
        Vec3f from{0, 0, 0}, d{0, 0, 0};
        from[axis] = -5 * way, d[axis] = way;
        EXPECT_TRUE(all_crossings(sponge(depth), {from, 0, d, kInf}).empty());
        // The edges of the cube are whole.
        from[(axis + 1) % 3] = from[(axis + 2) % 3] = -1 + 0x1p-24f;
        const std::vector<Hit> edge = all_crossings(sponge(depth), {from, 0, d, kInf});
        ASSERT_EQ(edge.size(), 2u);
        EXPECT_EQ(edge[0].t, 4);
        EXPECT_EQ(edge[1].t, 6);
      }
  }
}

TEST(Sphereflake, KnownCrossings) {
  // The root, a child on the x axis, its child beyond it, and so on up to the limit 2 - 3^-depth.
  for (const std::uint32_t depth : {0u, 1u, 4u, 12u}) {
    const std::vector<Hit> hits = all_crossings(flake(depth), {{5, 0, 0}, 0, {-1, 0, 0}, kInf});
    ASSERT_FALSE(hits.empty());
    // Children sit around the equator of their parent, not at its pole.
    EXPECT_FLOAT_EQ(hits[0].t, depth == 0 ? 4.0f : 5 - 5.0f / 3) << depth;
    EXPECT_FLOAT_EQ(hits.back().t, depth == 0 ? 6.0f : 5 + 5.0f / 3) << depth;
  }
  const std::vector<Hit> below = all_crossings(flake(12), {{0.25f, -3, 0.1f}, 0, {0, 1, 0}, kInf});
  ASSERT_FALSE(below.empty());
  EXPECT_FLOAT_EQ(below[0].t, static_cast<float>(3 - std::sqrt(1 - 0.25 * 0.25 - 0.1f * 0.1f)));
}

}  // namespace
}  // namespace oktett::fractal_shapes_test
