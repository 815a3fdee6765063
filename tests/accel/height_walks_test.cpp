#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "accel/query.h"
#include "tests/accel/all_crossings.h"
#include "tests/accel/height_field_cases.h"
#include "tests/support/sanitizers.h"

namespace oktett::height_walks_test {
namespace {

using namespace height_field_cases;

/// Hills that rays pass closely, and sharp peaks that they may miss; as 16-bit words or as floats.
HeightFieldShape hills(std::uint32_t columns, std::uint32_t rows, Interpolation interpolation, bool words) {
  std::vector<float> heights;
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      const float hill = std::sin(0.05f * static_cast<float>(i)) * std::cos(0.03f * static_cast<float>(j));
      const float roughness = random_float(11, i, j);
      heights.push_back(12 * hill + roughness + (roughness > 0.999f ? 20.0f : 0.0f));
    }
  HeightFieldShape s = height_field(columns, rows, heights, interpolation);
  if (!words) return s;
  Column<std::uint16_t> steps(heights.size());
  for (std::size_t i = 0; i < heights.size(); ++i)
    steps[i] = static_cast<std::uint16_t>((heights[i] + 16) * 1000);
  s.grid = HeightGrid::from_words(columns, rows, std::move(steps), interpolation);
  s.size.y = 65.535;
  return s;
}

/// The hits of a batch of rays, after a check that they are the same on all instruction sets and by all
/// traversals: rays alone, in flight, in packets, and those of a field that is the whole scene.
std::vector<Hit> closest(const HeightFieldShape& shape, HeightWalk walk, const RayBatch& rays) {
  HeightFieldShape s = shape;
  s.walk = walk;
  const auto accel = accel_of(s);
  std::vector<Hit> first;
  for (const Isa isa : available_isas()) {
    HitBatch hits;
    hits.resize_uninitialized(rays.size());
    closest_hit(*accel, rays.span(), hits.span(), isa);
    std::vector<std::uint8_t> occluded(rays.size());
    any_hit(*accel, rays.span(), occluded, isa);
    for (const TraceMode mode : {TraceMode::single, TraceMode::interleaved, TraceMode::packet8}) {
      HitBatch others;
      others.resize_uninitialized(rays.size());
      closest_hit(*accel, rays.span(), others.span(), isa, mode);
      for (std::size_t i = 0; i < rays.size(); ++i)
        EXPECT_EQ(others[i], hits[i]) << to_string(isa) << ", ray " << i;
    }
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (first.size() < rays.size())
        first.push_back(hits[i]);
      else
        EXPECT_EQ(hits[i], first[i]) << to_string(isa) << ", ray " << i;
      EXPECT_EQ(occluded[i], hits[i].valid()) << to_string(isa) << ", ray " << i;
    }
  }
  return first;
}

/// At every level of the pyramid, packets of close rays (from near and far, along the axes and across them)
/// and single rays find what a walk over every cell finds.
TEST(HeightWalks, PyramidsLeaveNothingOut) {
  const std::pair<std::uint32_t, std::uint32_t> sizes[] = {{300, 700}, {kMaxHeightSide, 4}, {3, 5000}};
  for (const auto& [columns, rows] : sizes)
    for (const Interpolation interpolation : kAll)
      for (const bool closed : {false, true}) {
        const bool words = closed == (interpolation == Interpolation::triangles);
        HeightFieldShape s = hills(columns, rows, interpolation, words);
        if (closed) s = solid(s, -14);
        RayBatch rays;
        for (std::uint32_t n = 0; n < test::cases(400); ++n) {
          const Vec3f half{columns * 0.5f, 20, rows * 0.5f};
          Vec3f at = random_point(2 * n, half), from = random_point(2 * n + 1, half * 1.2f);
          if (n % 4 == 1) from = at + (from - at) * 1e3f;
          if (n % 4 == 2) from = at + (from - at) * (8 / length(from - at));
          Vec3f d = at - from;
          if (n % 9 == 3) d.x = 0;
          if (n % 9 == 5) d.z = 0;
          if (n % 9 == 7) d.y = 0;
          if (n % 9 == 8) d.y = -1e-3f * std::abs(d.x);
          if (words) from.y += 16, at.y += 16;
          // Eight of a packet, as close as 1/2 or as far as 60 cells.
          const float spread = n % 16 == 15 ? 60.0f : n % 3 == 0 ? 0.5f : 4.0f;
          const float tmax = n % 5 == 0 ? 0.9f : kInf;
          for (std::uint32_t k = 0; k < 8; ++k) {
            const Vec3f aside = random_point(10000 + 8 * n + k, {spread, spread * 0.2f, spread});
            rays.push_back({from, n % 7 == 0 ? 0.3f : 0.0f, d + aside, tmax});
          }
        }
        const std::vector<Hit> all = closest(s, HeightWalk::cells, rays);
        const std::vector<Hit> found = closest(s, HeightWalk::pyramid, rays);
        std::size_t hits = 0;
        for (std::size_t i = 0; i < all.size(); ++i) {
          EXPECT_EQ(found[i], all[i]) << "ray " << i;
          hits += all[i].valid();
        }
        EXPECT_GT(hits, rays.size() / (test::kSanitized ? 20 : 10)) << columns;
      }
}

/// Batches of rays that make floats and their bounds fail if anything does: at exactly the height of samples,
/// along lines of the grid and diagonals, upright, at the borders of blocks, from as far as floats reach, and
/// cut off. Fields have one cell, blocks that are not full, and nodes of 2 x 2 blocks; heights are as great
/// as floats can be, or all the same.
TEST(HeightWalks, PyramidsBearHostileRays) {
  const auto sample = [](int kind, std::uint32_t i, std::uint32_t j) {
    if (kind == 0) return 4 * random_float(3, i, j);
    if (kind == 1) return 2.5f;
    if (kind == 2) return i == 0 && j == 0 ? 3.0f : 0.0f;
    return (random_float(3, i, j) - 0.5f) * 1e37f;
  };
  for (const auto& [columns, rows] : {std::pair{2u, 2u}, {2u, 70u}, {18u, 23u}, {150u, 66u}, {33u, 513u}})
    for (int kind = 0; kind < 4; ++kind) {
      const auto interpolation = kAll[(columns + static_cast<std::uint32_t>(kind)) % 3];
      std::vector<float> heights;
      for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) heights.push_back(sample(kind, i, j));
      HeightFieldShape s = height_field(columns, rows, heights, interpolation);
      const float unit = kind == 3 ? 1e37f : 1.0f;
      s.size = {(columns - 1.0) * unit, 1, (rows - 1.0) * unit};
      if (kind % 2 == 0) s = solid(s, -1);
      const auto place = [&](double k, std::uint32_t samples) {
        return static_cast<float>(k - (samples - 1) / 2.0) * unit;
      };
      RayBatch rays;
      for (std::uint32_t n = 0; n < test::cases(300); ++n) {
        const auto pick = [&](std::uint32_t k, std::uint32_t most) {
          return static_cast<std::uint32_t>(random_float(7, n, k) * 0.999f * static_cast<float>(most));
        };
        // Samples, and every third time those at the borders of blocks.
        const std::uint32_t step = n % 3 == 0 ? 4 : 1;
        const std::uint32_t i = pick(0, (columns - 1) / step + 1) * step,
                            j = pick(1, (rows - 1) / step + 1) * step;
        const std::uint32_t k = pick(2, columns), l = pick(3, rows);
        const Vec3f at{place(i, columns), heights[i + j * columns], place(j, rows)};
        const Vec3f other{place(k, columns), heights[k + l * columns], place(l, rows)};
        Vec3f d = at - other;
        if (n % 8 == 1) d = {0, -unit, 0};
        if (n % 8 == 2) d = {unit, 0, 0};
        if (n % 8 == 3) d = {0, 0, -unit};
        if (n % 8 == 4) d = {-unit, 0, unit};
        if (n % 8 == 5) d.y = 0;
        if (n % 8 == 6) d = {unit, 1e-6f * unit, -1e-36f * unit};
        const float back[] = {0, 0.5f, 3, 1000};
        Vec3f from = at - d * (kind == 3 ? 0.3f : back[n / 8 % 4]);
        if (n % 32 == 31 && kind != 3) from = at - d * 1e8f;
        rays.push_back({from, n % 5 == 0 ? 0.4f : 0.0f, d, n % 7 == 0 ? 1.0f : kInf});
      }
      const std::vector<Hit> all = closest(s, HeightWalk::cells, rays);
      const std::vector<Hit> found = closest(s, HeightWalk::pyramid, rays);
      std::size_t hits = 0;
      for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_EQ(found[i], all[i]) << columns << " x " << rows << ", kind " << kind << ", ray " << i;
        hits += all[i].valid();
      }
      EXPECT_GT(hits, test::kSanitized ? 0u
                      : kind == 3      ? 10u
                                       : 30u)
          << columns << " x " << rows << ", kind " << kind;
    }
}

/// No walk leaves out a cell, for any ray.
TEST(HeightWalks, AllWalksFindTheSame) {
  for (const Interpolation interpolation : kAll)
    for (const auto& [columns, rows] : {std::pair{2u, 3u}, {9u, 9u}, {23u, 40u}})
      for (const bool closed : {false, true}) {
        HeightFieldShape s = rough(columns, rows, interpolation);
        if (closed) s = solid(s, -1);
        std::vector<Ray> rays = hostile_rays(s);
        for (std::uint32_t n = 0; n < test::cases(250); ++n) {
          const Vec3f half{columns * 1.0f, 4, rows * 1.0f};
          const Vec3f from = random_point(2 * n, half), at = random_point(2 * n + 1, half * 0.4f);
          const float tmin = n % 3 == 0 ? 0.5f * random_float(9, n, 0) : 0;
          rays.push_back({from, tmin, at - from, n % 4 == 0 ? 0.8f : kInf});
        }
        HeightFieldShape other = s;
        std::vector<std::vector<Hit>> reference;
        std::size_t hits = 0;
        for (const HeightWalk walk : kWalks) {
          other.walk = walk;
          const auto accel = accel_of(other);
          for (std::size_t i = 0; i < rays.size(); ++i) {
            std::vector<Hit> all = all_crossings(*accel, rays[i]);
            hits += all.size();
            if (walk == kWalks[0])
              reference.push_back(std::move(all));
            else
              EXPECT_EQ(all, reference[i]) << "walk " << static_cast<int>(walk) << ", ray " << i;
          }
        }
        EXPECT_GT(hits, rays.size() / 4);
      }
}

/// A ray from far below to far above that stays inside of the rectangle crosses an odd number of times, also
/// through samples and along edges and diagonals.
TEST(HeightWalks, NoRaySlipsThrough) {
  for (const Interpolation interpolation : kAll)
    for (const std::uint32_t size : {9u, 14u}) {
      const auto s = rough(size, size, interpolation);
      const auto accel = accel_of(s);
      const auto check = [&](const Vec3f& from, const Vec3f& to) {
        const std::vector<Hit> all = all_crossings(*accel, {from, 0, to - from, kInf});
        ASSERT_EQ(all.size() % 2, 1u) << from.x << " " << from.y << " " << from.z;
        EXPECT_EQ(all[0].v, from.y < to.y ? 1 : -1);
      };
      const float half = (static_cast<float>(size) - 1) / 2;
      const auto at = [&](std::uint32_t k) { return static_cast<float>(k) - half; };
      for (std::uint32_t i = 0; i < size; ++i)
        for (std::uint32_t j = 0; j < size; ++j)
          for (std::uint32_t k = 1; k + 1 < size; ++k) {
            // Between grid points below and above, the middle of the way, too, often on a grid point.
            const std::uint32_t m = (i * 7 + j * 3 + k * 5) % (size - 2) + 1;
            if (i > 0 && j > 0 && i + 1 < size && j + 1 < size) {
              check({at(i), -4, at(j)}, {at(k), 8, at(m)});
              check({at(k), 8, at(m)}, {at(i), -4, at(j)});
              check({at(i), 8, at(j)}, {at(i), -4, at(m)});
              check({at(i), 8, at(j)}, {at(k), -4, at(j)});
              check({at(i) + 0.5f, 8, at(j)}, {at(k), -4, at(m) + 0.25f});
            }
          }
    }
}

/// The same after transforms that round all grid points.
TEST(HeightWalks, ClosedOnesAreEnteredAsOftenAsLeft) {
  for (const Interpolation interpolation : kAll) {
    const auto s = solid(rough(12, 7, interpolation), -1);
    for (const double size : {1e-3, 1.0, 1e4}) {
      const Affine place = Affine::translation({3 * size, -2 * size, size}) * Affine::rotation({20, 50, 70}) *
                           Affine::scaling({size, size, 2 * size});
      const auto accel = accel_of(s, place);
      int hits = 0;
      for (const Ray& ray : hostile_rays(s)) {
        const Ray moved{Vec3f(place.point(Vec3d(ray.origin))), 0, Vec3f(place.vector(Vec3d(ray.direction))),
                        kInf};
        const std::vector<Hit> all = all_crossings(*accel, moved);
        EXPECT_EQ(all.size() % 2, 0u);
        for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i].v, i % 2 == 0 ? -1 : 1);
        hits += !all.empty();
      }
      EXPECT_GT(hits, 300);
    }
  }
}

TEST(HeightWalks, BadRaysHitNothing) {
  for (const Interpolation interpolation : kAll)
    for (const HeightWalk walk : kWalks) {
      HeightFieldShape s = rough(6, 6, interpolation);
      s.walk = walk;
      const auto accel = accel_of(s);
      for (int k = 0; k < 3; ++k) {
        for (const float bad : {kNan, kInf, -kInf}) {
          Vec3f v{0.1f, 9, 0.3f};
          v[k] = bad;
          EXPECT_TRUE(all_crossings(*accel, {v, 0, {0.1f, -1, 0}, kInf}).empty()) << bad;
        }
        Vec3f d{0.1f, -1, 0.3f};
        d[k] = kNan;
        EXPECT_TRUE(all_crossings(*accel, {{0, 9, 0}, 0, d, kInf}).empty());
      }
      EXPECT_TRUE(all_crossings(*accel, {{0.5f, 1, 0}, 0, {0, 0, 0}, kInf}).empty());
    }
}

/// Scaling the field or the direction by a power of two changes no bit.
TEST(HeightWalks, TinyAndHuge) {
  for (const Interpolation interpolation : kAll) {
    const auto s = solid(rough(9, 6, interpolation), -1);
    const auto unit = accel_of(s);
    int hits = 0;
    for (const int exponent : {-50, 50}) {
      const double scale = std::ldexp(1.0, exponent);
      const auto f = static_cast<float>(scale);
      const auto scaled = accel_of(s, Affine::scaling({scale, scale, scale}));
      for (std::uint32_t i = 0; i < 60; ++i) {
        const Vec3f from = random_point(i, {9, 6, 9}), d = random_point(i + 100, {4, 3, 3}) - from;
        const std::vector<Hit> expected = all_crossings(*unit, {from, 0, d, kInf});
        EXPECT_EQ(all_crossings(*scaled, {from * f, 0, d * f, kInf}), expected) << i;
        hits += !expected.empty();
      }
    }
    EXPECT_GT(hits, 60);
  }
}

/// From so far away that a float cannot resolve a cell, the ray may miss, but a hit lies on the ray, and the
/// search ends.
TEST(HeightWalks, FarAway) {
  for (const Interpolation interpolation : kAll)
    for (const HeightWalk walk : kWalks) {
      HeightFieldShape s = solid(rough(40, 40, interpolation), -1);
      s.walk = walk;
      const auto accel = accel_of(s);
      for (const float far : {1e6f, 1e12f, 1e25f})
        for (const Vec3f& d : {Vec3f{0, -1, 0}, Vec3f{1, -1, 1}, Vec3f{-1, -1, 2}, Vec3f{1, 0, 0}}) {
          const std::vector<Hit> all = all_crossings(*accel, {d * -far, 0, d, kInf});
          for (const Hit& h : all) EXPECT_NEAR(h.t, far, 100 + 1e-6 * far);
          if (far < 1e7f) {
            EXPECT_GE(all.size(), 1u);
          }
        }
    }
}

/// A ray that ends before the field, or in it, finds only what is before its end.
TEST(HeightWalks, RaysEnd) {
  for (const Interpolation interpolation : kAll)
    for (const bool closed : {false, true}) {
      HeightFieldShape s = rough(20, 20, interpolation);
      if (closed) s = solid(s, -1);
      const auto accel = accel_of(s);
      int cut = 0;
      for (std::uint32_t i = 0; i < 200; ++i) {
        const Vec3f from = random_point(i, {15, 6, 15}), d = random_point(i + 500, {8, 3, 8}) - from;
        const std::vector<Hit> all = all_crossings(*accel, {from, 0, d, kInf});
        for (std::size_t k = 0; k < all.size(); ++k) {
          const float t = all[k].t;
          if (k + 1 < all.size() && all[k + 1].t == t) continue;
          EXPECT_EQ(all_crossings(*accel, {from, 0, d, t}),
                    std::vector<Hit>(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(k) + 1));
          if (k > 0 && all[k - 1].t == t) continue;
          EXPECT_EQ(all_crossings(*accel, {from, t, d, kInf}),
                    std::vector<Hit>(all.begin() + static_cast<std::ptrdiff_t>(k) + 1, all.end()));
          ++cut;
        }
      }
      EXPECT_GT(cut, 100);
    }
}

/// The first of all hits, if it is not beyond the end of the ray.
float first_before(const std::vector<Hit>& all, float end) {
  return !all.empty() && all[0].t <= end ? all[0].t : kInf;
}

// A walk may look at some of the cells behind the end of the ray. A crossing in them need not be the first
// one, so it must not decide whether the ray starts inside.
TEST(HeightWalks, EndsOfRaysDoNotMoveTheStart) {
  for (const Interpolation interpolation : kAll)
    for (const HeightWalk walk : kWalks)
      for (const bool closed : {false, true}) {
        HeightFieldShape s = rough(13, 15, interpolation, 9);
        if (closed) s = solid(s, -2);
        s.walk = walk;
        const auto accel = accel_of(s);
        std::vector<Ray> rays;
        std::vector<float> expected;
        for (std::uint32_t i = 0; i < test::cases(3000); ++i) {
          const Vec3f from = random_point(2 * i, {20, 12, 20});
          Ray ray{from, 0, random_point(2 * i + 1, {6, 9, 7}) - from, kInf};
          std::vector<Hit> all;
          all_hits(*accel, ray, all);
          for (float end = 0.05f; end < 2; end *= 1.1f) {
            ray.tmax = end, rays.push_back(ray), expected.push_back(first_before(all, end));
          }
        }
        for (const Isa isa : available_isas()) {
          std::vector<Hit> hits(rays.size());
          closest_hit(*accel, rays, hits, isa);
          for (std::size_t i = 0; i < rays.size(); ++i)
            ASSERT_EQ(hits[i].valid() ? hits[i].t : kInf, expected[i])
                << "interpolation " << static_cast<int>(interpolation) << ", walk " << static_cast<int>(walk)
                << ", " << (closed ? "closed" : "open") << ", up to " << rays[i].tmax << ", "
                << to_string(isa);
        }
      }
}

}  // namespace
}  // namespace oktett::height_walks_test
