/// \file Beams give the same bits as one ray at a time by the scalar path, for all kinds of meshes, apexes
/// and rays.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/accel/same_hits.h"
#include "tests/support/dice.h"
#include "tests/support/grid_triangles.h"
#include "tests/support/limits.h"

namespace oktett::beam_test {
namespace {

TriangleMesh grid_mesh(int n, bool flat, Dice<float>& dice) {
  TriangleMesh m;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x)
      m.positions.push_back({2.0f * static_cast<float>(x) / static_cast<float>(n) - 1,
                             2.0f * static_cast<float>(y) / static_cast<float>(n) - 1,
                             flat ? 0.0f : dice.range(-0.05f, 0.05f)});
  add_grid_triangles(m, static_cast<std::uint32_t>(n));
  return m;
}

TriangleMesh soup(int n, float size, Dice<float>& dice) {
  TriangleMesh m;
  for (int i = 0; i < n; ++i) {
    const Vec3f at = dice.vec(1);
    for (int k = 0; k < 3; ++k) {
      m.positions.push_back(at + dice.vec(size));
      m.indices.push_back(static_cast<std::uint32_t>(3 * i + k));
    }
  }
  return m;
}

TriangleMesh scaled(TriangleMesh m, float scale, const Vec3f& shift) {
  for (Vec3f& p : m.positions) p = p * scale + shift;
  return m;
}

/// A structure, and the points at which rays are aimed.
struct Subject {
  std::vector<TriangleMesh> meshes;
  std::shared_ptr<const Accel> accel;
  std::vector<Vec3f> targets;
  float scale = 1;
  Vec3f center{0, 0, 0};
  BuildQuality quality = BuildQuality::balanced;
};

void finish(Subject& s, std::vector<Geometry> more = {}) {
  std::vector<Geometry> geometries;
  for (const TriangleMesh& m : s.meshes) {
    geometries.emplace_back();
    geometries.back().shape = MeshGeometry{&m};
    for (const Vec3f& p : m.positions) s.targets.push_back(p);
    for (std::size_t i = 0; i + 2 < m.indices.size(); i += 3) {
      const Vec3f a = m.positions[m.indices[i]], b = m.positions[m.indices[i + 1]],
                  c = m.positions[m.indices[i + 2]];
      s.targets.push_back((a + b) * 0.5f), s.targets.push_back((a + b + c) * (1 / 3.0f));
    }
  }
  for (Geometry& g : more) geometries.push_back(std::move(g));
  s.accel = build_accel(std::move(geometries), {s.quality});
}

constexpr int kSubjects = 9;
/// Batches of rays per subject and test.
constexpr int kRounds = 60;

Subject make_subject(int which, Dice<float>& dice) {
  Subject s;
  switch (which) {
    case 0:
      s.meshes = {grid_mesh(20, true, dice)};
      break;
    case 1:
      // Triangles that stand in several leaves.
      s.quality = BuildQuality::best;
      s.meshes = {grid_mesh(40, false, dice), soup(200, 0.3f, dice)};
      break;
    case 2:
      s.meshes = {soup(3000, 0.02f, dice)};
      break;
    case 3:
      s.quality = BuildQuality::best;
      s.meshes = {soup(100, 1e-5f, dice), soup(30, 2, dice)};
      break;
    case 4:  // far from the origin: coordinates are coarse
      s.center = {1000, -3000, 500}, s.meshes = {scaled(soup(500, 0.1f, dice), 1, s.center)};
      break;
    case 5:
      s.scale = 1e-9f, s.meshes = {scaled(soup(500, 0.1f, dice), s.scale, s.center)};
      break;
    case 6:
      s.scale = 1e10f, s.meshes = {scaled(soup(500, 0.1f, dice), s.scale, s.center)};
      break;
    case 7:  // beyond what beams accept
      s.scale = 1e18f, s.meshes = {scaled(soup(200, 0.1f, dice), s.scale, s.center)};
      break;
    default: {
      s.meshes = {grid_mesh(16, false, dice)};
      finish(s);
      std::vector<Geometry> more(5);
      more[0].shape = SpheresShape{{{{0.3, 0.2, 0.1}, 0.25}, {{-0.4, 0.1, 0.2}, 0.3}, {{0, 0, 3}, 0.5}}};
      more[1].shape = PlaneShape{{0, 0, 1}, -0.5};
      more[2].shape = BoxShape{{-0.2, -0.9, -0.2}, {0.1, -0.5, 0.4}};
      more[3].shape = InstanceGeometry{s.accel};
      more[3].transform = Affine::translation({0.1, 0.2, 0.3}) * Affine::rotation({1, 2, 3}, 40);
      more[4].shape = MeshGeometry{&s.meshes[0], true, TriangleTest::moller_trumbore};
      more[4].transform = Affine::translation({0, 0, -0.2});
      const std::shared_ptr<const Accel> kept = s.accel;
      s.targets.clear();
      finish(s, std::move(more));
      return s;
    }
  }
  finish(s);
  return s;
}

/// Directions of a bundle towards a target: pixels, targets hit exactly, one direction, or a wide cone.
Vec3f bundle_direction(int kind, int i, const Vec3f& from, const Vec3f& target, const Subject& s,
                       Dice<float>& dice) {
  const Vec3f to = target - from;
  const float reach = length(to);
  Vec3f u, v;
  make_basis(normalize(to), u, v);
  const float side = kind == 0 ? 0.3f : kind == 3 ? 2.5f : 0.002f;
  if (kind == 0 || kind == 4) {
    const float x = static_cast<float>(i % 4 + i / 16 % 4 * 4) / 16 - 0.5f,
                y = static_cast<float>(i / 4 % 4 + i / 64 * 4) / 16 - 0.5f;
    return to + (u * x + v * y) * (side * reach);
  }
  if (kind == 1) {
    // Exactly at vertices, middles of edges and of faces near the target.
    for (int tries = 0; tries < 50; ++tries) {
      const Vec3f p = s.targets[static_cast<std::size_t>(dice.below(static_cast<int>(s.targets.size())))];
      if (length(p - target) < 0.3f * reach) return p - from;
    }
    return to;
  }
  if (kind == 2) return to;
  return to + (u * dice.range(-0.5f, 0.5f) + v * dice.range(-0.5f, 0.5f)) * (side * reach);
}

/// Some rays that hit nothing, or only in a part of their range.
void trouble(Ray& r, Dice<float>& dice) {
  const int what = dice.below(40);
  if (what == 0) r.direction.y = kNan;
  if (what == 1) r.direction = {0, 0, 0};
  if (what == 2) r.tmax = kNan;
  if (what == 3) r.tmax = r.tmin;
  if (what == 4) r.direction.x = 0;
  if (what == 5) r.direction.z = -0.0f;
}

Vec3f random_apex(const Subject& s, Dice<float>& dice) {
  switch (dice.below(5)) {
    case 0:
      return s.targets[static_cast<std::size_t>(dice.below(static_cast<int>(s.targets.size())))];
    case 1:
      return s.center + dice.vec(1) * s.scale;
    case 2:
      return s.center +
             Vec3f{dice.range(-1, 1), dice.range(-1, 1), 0} * s.scale;  // in the plane of the flat grid
    case 3:
      return s.center + dice.vec(4) * s.scale;
    default:
      return s.center + dice.vec(300) * s.scale;
  }
}

void expect_same(const Subject& s, const RayBatch& rays, const std::string& what) {
  expect_hits(*s.accel, rays, scalar_hits(*s.accel, rays),
              {TraceMode::single, TraceMode::automatic, TraceMode::beam}, what);
}

class Beams : public testing::TestWithParam<int> {};

TEST_P(Beams, CommonOrigin) {
  Dice<float> dice(17 + static_cast<std::uint32_t>(GetParam()));
  const Subject s = make_subject(GetParam(), dice);
  for (int round = 0; round < kRounds; ++round) {
    const Vec3f from = random_apex(s, dice);
    const Vec3f target = s.targets[static_cast<std::size_t>(dice.below(static_cast<int>(s.targets.size())))];
    const int kind = dice.below(5), ends = dice.below(4);
    const int count = dice.below(3) == 0 ? 1 + dice.below(700) : 512;
    const float stretch = dice.below(3) == 0 ? std::exp2(dice.range(-20, 20)) : 1;
    RayBatch rays;
    for (int i = 0; i < count; ++i) {
      Ray r{from, 0, bundle_direction(kind, i, from, target, s, dice) * stretch};
      if (ends == 1) r.tmax = dice.range(0.2f, 2) / stretch;
      if (ends == 2) r.tmin = dice.range(0, 1) / stretch;
      if (ends == 3) r.tmin = 0.5f / stretch, r.tmax = 1.01f / stretch;
      trouble(r, dice);
      rays.push_back(r);
    }
    // Again, ending exactly at what was hit, just before it, and just behind it.
    const HitBatch hits = scalar_hits(*s.accel, rays);
    expect_same(s, rays, "origin, round " + std::to_string(round));
    if (HasFailure()) return;
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (hits[i].valid()) {
        const int how = dice.below(4);
        if (how == 0) rays.tmax[i] = hits.t[i];
        if (how == 1) rays.tmax[i] = std::nextafter(hits.t[i], 0.0f);
        if (how == 2) rays.tmin[i] = hits.t[i], rays.tmax[i] = kInf;
        if (how == 3) rays.tmin[i] = std::nextafter(hits.t[i], 0.0f), rays.tmax[i] = kInf;
      }
    expect_same(s, rays, "cut, round " + std::to_string(round));
    if (HasFailure()) return;
  }
}

TEST_P(Beams, CommonEnd) {
  Dice<float> dice(99 + static_cast<std::uint32_t>(GetParam()));
  const Subject s = make_subject(GetParam(), dice);
  for (int round = 0; round < kRounds; ++round) {
    const Vec3f light = random_apex(s, dice);
    const Vec3f near = s.targets[static_cast<std::size_t>(dice.below(static_cast<int>(s.targets.size())))];
    const int kind = dice.below(4), count = dice.below(3) == 0 ? 1 + dice.below(700) : 512;
    const float lift = dice.below(2) == 0 ? 0.0f : 1e-4f;
    const bool unit = dice.below(2) == 0;
    RayBatch rays;
    for (int i = 0; i < count; ++i) {
      Vec3f from = s.targets[static_cast<std::size_t>(dice.below(static_cast<int>(s.targets.size())))];
      if (kind == 0) from = near + dice.vec(0.05f) * s.scale;
      if (kind == 1) from = near + (from - near) * 0.02f;
      if (kind == 2)
        from = near + Vec3f{static_cast<float>(i % 16), static_cast<float>(i / 16), 0} * (0.003f * s.scale);
      from += dice.vec(1) * (lift * s.scale);
      const Vec3f to = light - from;
      const float distance = length(to);
      Ray r{from, 0, to, 1};
      if (unit) r = {from, 0, to / distance, distance};
      trouble(r, dice);
      rays.push_back(r);
    }
    expect_same(s, rays, "end, round " + std::to_string(round));
    if (HasFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(Subjects, Beams, testing::Range(0, kSubjects));

}  // namespace
}  // namespace oktett::beam_test
