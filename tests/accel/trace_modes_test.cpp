/// \file Every trace mode and instruction set finds the same hits.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "tests/accel/same_hits.h"
#include "tests/support/limits.h"
#include "verify/cases/kernel_cases.h"
#include "verify/oracles/closed.h"

namespace oktett::trace_modes_test {
namespace {

constexpr BuildQuality kQualities[] = {BuildQuality::balanced, BuildQuality::best, BuildQuality::compact};

TriangleMesh soup(int count, std::uint64_t seed, double scale, const Vec3d& shift = {}) {
  TriangleMesh m;
  CaseRandom r(seed);
  for (int i = 0; i < count; ++i) {
    const Vec3d c = r.vector();
    const double size = i % 10 == 0 ? 0.6 : 0.05;
    for (int k = 0; k < 3; ++k) {
      Vec3d p = c + r.vector() * size;
      if (i % 7 == 0) p.z = 0.25;  // flat boxes
      m.indices.push_back(static_cast<std::uint32_t>(m.positions.size()));
      m.positions.push_back(Vec3f(p * scale + shift));
    }
  }
  return m;
}

/// Rays towards vertices, edges and faces, along axes, and past everything; from near, from far, and with
/// ranges that end at their target.
RayBatch rays_at(const TriangleMesh& m, int count, std::uint64_t seed, double scale, const Vec3d& shift) {
  RayBatch rays;
  CaseRandom r(seed);
  for (int i = 0; i < count; ++i) {
    const std::size_t t = 3 * (r.bits() % m.triangle_count());
    const auto corner = [&](std::size_t k) { return Vec3d(m.positions[m.indices[t + k]]); };
    const double u = i % 3 == 0 ? 0 : r.unit(), v = i % 4 == 0 ? 0 : r.unit() * (1 - u);
    const Vec3d target = corner(0) * (1 - u - v) + corner(1) * u + corner(2) * v;
    Vec3d from = r.vector() * (scale * (i % 5 == 0 ? 40 : 1.5)) + shift;
    if (i / 16 % 3 == 0) from = Vec3d{1.5, 0.5, 1} * scale + shift;  // many from one point
    Ray ray{Vec3f(from), 0, Vec3f(target) - Vec3f(from), i % 6 == 0 ? 1.0f : kInf};
    if (i % 11 == 0) ray.direction[static_cast<int>(r.bits() % 3)] = i % 2 == 0 ? 0.0f : -0.0f;
    if (i % 13 == 0) ray.direction = {0, 0, static_cast<float>(-scale)};
    if (i % 17 == 0) ray.direction = ray.direction / static_cast<float>(scale);
    if (i % 97 == 0) ray.direction.y = std::numeric_limits<float>::quiet_NaN();
    rays.push_back(ray);
  }
  return rays;
}

/// The hits in `other`, in every mode, are those of single rays of the scalar code in `plain`. Returns the
/// number of rays that hit.
int expect_same(const Accel& plain, const Accel& other, const RayBatch& rays, const std::string& what) {
  const int found = expect_hits(other, rays, scalar_hits(plain, rays), kTraceModes, what);
  if (testing::Test::HasFailure()) return 0;
  std::vector<Hit> a, b;
  HitLists lists;
  for (const Isa isa : available_isas()) {
    all_hits(other, rays, lists, isa);
    for (std::size_t i = 0; i < rays.size(); i += 7) {
      all_hits(plain, rays[i], a, Isa::scalar), all_hits(other, rays[i], b, isa);
      EXPECT_EQ(a, b) << what << ' ' << to_string(isa) << " ray " << i;
      EXPECT_TRUE(std::ranges::equal(a, lists.of_ray(i))) << what << ' ' << to_string(isa) << " ray " << i;
    }
  }
  return found;
}

struct Place {
  double scale;
  Vec3d shift;
};
const Place kPlaces[] = {
    {1, {}},    {1, {3000, -70000, 5}}, {1e-9, {}}, {1e-20, {}}, {1e-25, {}}, {1e10, {}}, {1e20, {}},
    {1e30, {}}, {1e-3, {1, 1, 1}},      {1e38, {}}};

TEST(TraceModes, SameHitsAtEveryScale) {
  for (const Place& p : kPlaces)
    for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::best}) {
      const TriangleMesh m = soup(900, 3, p.scale, p.shift);
      const std::vector<Geometry> geometries = {{MeshGeometry{&m}, {}, kNoId}};
      const auto plain = build_accel(geometries), other = build_accel(geometries, {quality});
      const RayBatch rays = rays_at(m, 1500, 4, p.scale, p.shift);
      const int found = expect_same(*plain, *other, rays, "scale " + std::to_string(p.scale));
      if (HasFailure()) return;
      if (p.scale < 1e35) {
        EXPECT_GT(found, 800) << p.scale;
      }
    }
}

/// Finite rays in groups of 128 that start close together. In odd groups many end exactly on a vertex. Every
/// other even group has a ray that is endless or not a number, and before it one that is longer than the
/// others.
RayBatch short_rays(const TriangleMesh& m, int groups, std::uint64_t seed, double scale, const Vec3d& shift) {
  RayBatch rays;
  CaseRandom r(seed);
  for (int g = 0; g < groups; ++g) {
    const Vec3d center = r.vector() * scale + shift;
    const bool wide = g % 2 == 1, broken = g % 4 == 0;
    for (int i = 0; i < 128; ++i) {
      const Vec3d from = center + r.vector() * (scale * (wide ? 0.3 : 0.02));
      Vec3d to = from + r.vector() * (scale * (wide ? 0.2 : 0.05));
      if ((wide && i % 4 == 0) || (broken && i == 101))
        to = Vec3d(m.positions[m.indices[r.bits() % m.indices.size()]]);
      Ray ray{Vec3f(from), 0, Vec3f(to) - Vec3f(from),
              i % 3 == 0 ? 1.0f : static_cast<float>(0.5 + r.unit())};
      if (i % 9 == 0) ray.direction[static_cast<int>(r.bits() % 3)] = 0;
      if (broken && i == 109) {
        if (g % 8 == 0) ray.tmax = kInf;
        (g % 8 == 0 ? ray.direction : ray.origin).x =
            g % 8 == 0 ? 0 : std::numeric_limits<float>::quiet_NaN();
      }
      rays.push_back(ray);
    }
  }
  return rays;
}

TEST(TraceModes, SameHitsOfShortRays) {
  for (const Place& p : kPlaces) {
    const TriangleMesh m = soup(900, 3, p.scale, p.shift);
    const std::vector<Geometry> geometries = {{MeshGeometry{&m}, {}, kNoId}};
    const auto plain = build_accel(geometries), other = build_accel(geometries, {BuildQuality::best});
    const RayBatch rays = short_rays(m, 24, 8, p.scale, p.shift);
    const int found = expect_same(*plain, *other, rays, "scale " + std::to_string(p.scale));
    if (HasFailure()) return;
    if (p.scale < 1e35) {
      EXPECT_GT(found, 400) << p.scale;
    }
  }
}

// Meshes of both kinds of triangle test, closed-form shapes, a plane, exact surfaces and instances in one
// tree; instances of trees of another quality change nothing.
TEST(TraceModes, SameHitsOfMixedKinds) {
  const TriangleMesh m = soup(300, 5, 1), textbook = soup(60, 6, 1);
  std::shared_ptr<const Accel> child[2];
  for (int i = 0; i < 2; ++i) child[i] = build_accel({{MeshGeometry{&m}, {}, kNoId}}, {kQualities[i]});
  std::vector<Geometry> geometries = {{MeshGeometry{&m}, {}, kNoId}};
  geometries.push_back({MeshGeometry{&textbook, true, TriangleTest::moller_trumbore}, {}, kNoId});
  geometries.push_back({PlaneShape{{0, 0, 1}, -0.7}, {}, kNoId});
  CaseRandom r(7);
  std::vector<Geometry> others = geometries;
  for (int i = 0; i < 120; ++i) {
    const Vec3d c = r.vector();
    const Affine at = Affine::translation(c) * Affine::scaling({0.3, 0.2, 0.1});
    for (std::vector<Geometry>* list : {&geometries, &others}) {
      const auto& inner = child[list == &others ? i / 4 % 2 : 0];
      if (i >= 90)
        list->push_back({ExactShape{TorusShape{1, 0.4}}, at, kNoId});
      else if (i % 4 == 0)
        list->push_back({SpheresShape{{{c, 0.05}}}, {}, kNoId});
      else if (i % 4 == 1)
        list->push_back({BoxShape{c, c + Vec3d{0.1, 0.1, 0.01}}, {}, kNoId});
      else if (i % 4 == 2)
        list->push_back({DiskShape{c, {0, 0, 1}, 0.1}, {}, kNoId});
      else
        list->push_back({InstanceGeometry{inner}, at, kNoId});
    }
  }
  const auto plain = build_accel(geometries);
  const RayBatch rays = rays_at(m, 1500, 8, 1, {});
  for (const BuildQuality quality : kQualities) {
    const auto other = build_accel(others, {quality});
    EXPECT_GT(expect_same(*plain, *other, rays, "mixed"), 800);
  }
}

TEST(TraceModes, SameHitsOfFewTriangles) {
  const TriangleMesh targets = soup(100, 10, 1);
  for (const int count : {0, 1, 8, 9}) {
    const TriangleMesh few = soup(count, 11, 1);
    const std::vector<Geometry> one = {{MeshGeometry{&few}, {}, kNoId}};
    const auto plain = build_accel(one), fast = build_accel(one, {BuildQuality::fast});
    expect_same(*plain, *fast, rays_at(targets, 200, 12, 1, {}), "few");
  }
}

/// Things whose hits are known without the library.
struct KnownThings {
  TriangleMesh mesh;
  std::vector<SphereShape> spheres;
  std::vector<DiskShape> disks;
  PlaneShape plane{{0, 0, 1}, -0.9};

  std::vector<Geometry> geometries() const {
    std::vector<Geometry> all = {
        {MeshGeometry{&mesh}, {}, kNoId}, {plane, {}, kNoId}, {SpheresShape{spheres}, {}, kNoId}};
    for (const DiskShape& disk : disks) all.push_back({disk, {}, kNoId});
    return all;
  }

  /// The nearest hit that the oracles find, one thing after the other; undecided if one of them is.
  OracleAnswer nearest(const Ray& ray) const {
    OracleAnswer best;
    const auto take = [&](const OracleAnswer& a) {
      if (best.verdict == OracleVerdict::undecided || a.verdict == OracleVerdict::miss) return;
      if (a.verdict == OracleVerdict::undecided || best.verdict == OracleVerdict::miss || a.t < best.t)
        best = a;
    };
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const Vec3f corner[] = {mesh.positions[mesh.indices[i]], mesh.positions[mesh.indices[i + 1]],
                              mesh.positions[mesh.indices[i + 2]]};
      take(oracle_triangle(ray, corner, {}));
    }
    for (const SphereShape& sphere : spheres) take(oracle_sphere(ray, sphere));
    for (const DiskShape& disk : disks) take(oracle_disk(ray, disk));
    take(oracle_plane(ray, plane));
    return best;
  }
};

// The other tests compare ways of tracing with each other. Here each is compared with a loop over all things
// in extended precision: rays of one apex, so that every beam is full, then all others.
TEST(TraceModes, NearestHitsAreThoseOfTheOracles) {
  KnownThings things;
  things.mesh = soup(300, 21, 1);
  CaseRandom r(22);
  for (int i = 0; i < 60; ++i) things.spheres.push_back({r.vector(), 0.02 + 0.1 * r.unit()});
  for (int i = 0; i < 60; ++i)
    things.disks.push_back({r.vector(), normalize(r.vector()), 0.02 + 0.1 * r.unit()});
  RayBatch rays;
  for (int beam = 0; beam < 8; ++beam) {
    const Vec3f apex(r.vector() * (beam % 2 == 0 ? 4.0 : 0.8));
    const Vec3d target = r.vector() * 0.7;
    for (int i = 0; i < 256; ++i) rays.push_back({apex, 0, Vec3f(target + r.vector() * 0.3) - apex, kInf});
  }
  const RayBatch others = rays_at(things.mesh, 1000, 23, 1, {});
  for (std::size_t i = 0; i < others.size(); ++i) rays.push_back(others[i]);
  std::vector<OracleAnswer> truth;
  int met = 0, missed = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    truth.push_back(things.nearest(rays[i]));
    met += truth[i].verdict == OracleVerdict::hit, missed += truth[i].verdict == OracleVerdict::miss;
  }
  EXPECT_GT(met, 1500);
  EXPECT_GT(missed, 100);
  EXPECT_GT(met + missed, 2900);
  const auto accel = build_accel(things.geometries());
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  for (const Isa isa : available_isas())
    for (const TraceMode mode : kTraceModes) {
      closest_hit(*accel, rays.span(), hits.span(), isa, mode);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if (truth[i].verdict == OracleVerdict::undecided) continue;
        ASSERT_EQ(hits[i].valid(), truth[i].verdict == OracleVerdict::hit)
            << to_string(isa) << ' ' << int(mode) << ' ' << i;
        if (hits[i].valid()) {
          ASSERT_NEAR(hits[i].t, truth[i].t, 2e-7 * truth[i].t + truth[i].t_error)
              << to_string(isa) << ' ' << int(mode) << ' ' << i;
        }
      }
    }
}

}  // namespace
}  // namespace oktett::trace_modes_test
