#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "accel/hit_place.h"
#include "accel/point_query.h"
#include "core/error.h"
#include "core/lanes.h"
#include "kernels/closed/closest_triangle.h"
#include "tests/support/limits.h"
#include "tests/support/triangle_cases.h"

namespace oktett::closest_point_test {
namespace {

using D = Simd<double, 1, ScalarIsa>;

/// The nearest triangle by trying all, in every place where instances show them. Triangles are taken in the
/// order of (instance, item).
ClosestPoint closest_of_all(const Accel& accel, const Vec3f& point) {
  struct Candidate {
    std::uint32_t instance, item;
    Vec3d corner[3];
  };
  double best_d2 = std::numeric_limits<double>::infinity();
  ClosestPoint best;
  visit_placed_geometries(accel, [&](const PlacedGeometry& placed) {
    const auto& mesh = *std::get<MeshGeometry>(placed.geometry->shape).mesh;
    const Affine& own = placed.geometry->transform;
    for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
      Vec3d v[3];
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3f& corner = mesh.positions[mesh.indices[3 * t + k]];
        v[k] = placed.instance == kNoId ? Vec3d(Vec3f(own.point(Vec3d(corner))))
                                        : placed.to_world.point(Vec3d(corner));
      }
      const auto c = closest_on_triangle(broadcast<D>(Vec3d(point)), broadcast<D>(v[0]), broadcast<D>(v[1]),
                                         broadcast<D>(v[2]));
      const double d2 = only_lane(c.d2);
      const std::uint32_t item = placed.first_item + t;
      const bool before =
          placed.instance + 1 < best.instance + 1 || (placed.instance == best.instance && item < best.item);
      if (d2 > best_d2 || (d2 == best_d2 && !before)) continue;
      best_d2 = d2;
      best.distance = static_cast<float>(std::sqrt(d2));
      best.u = static_cast<float>(only_lane(c.u)), best.v = static_cast<float>(only_lane(c.v));
      best.point = Vec3f(v[0] + ((v[1] - v[0]) * only_lane(c.u) + (v[2] - v[0]) * only_lane(c.v)));
      best.item = item, best.instance = placed.instance;
    }
  });
  return best;
}

/// The answers for `points` on every instruction set and by every way to ask against all triangles tried.
void expect_closest(const Accel& accel, const std::vector<Vec3f>& points) {
  Column<float> columns[3];
  for (const Vec3f& p : points)
    for (int k = 0; k < 3; ++k) columns[k].push_back(p[k]);
  const PointSpan span{{columns[0].data(), columns[1].data(), columns[2].data()}, points.size()};
  std::vector<ClosestPoint> expected;
  for (const Vec3f& p : points) expected.push_back(closest_of_all(accel, p));
  std::vector<ClosestPoint> scalar(points.size()), found(points.size());
  closest_point(accel, points, scalar, Isa::scalar);
  for (const Isa isa : available_isas()) {
    closest_point(accel, points, found, isa);
    Column<float> distance(points.size());
    Column<std::uint32_t> item(points.size());
    ClosestPointSpan some;
    some.distance = distance.data(), some.item = item.data(), some.size = points.size();
    closest_point(accel, span, some, isa);
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(found[i], scalar[i]) << to_string(isa) << ", point " << i;
      ASSERT_EQ(distance[i], found[i].distance);
      ASSERT_EQ(item[i], found[i].item);
      ClosestPoint e = expected[i];
      e.normal = found[i].normal;
      ASSERT_EQ(found[i].item, e.item) << "point " << i << ": " << found[i].distance << " " << e.distance;
      ASSERT_EQ(found[i], e) << to_string(isa) << ", point " << i;
      if (i % 16 == 0) {
        ASSERT_EQ(closest_point(accel, points[i], isa), found[i]);
      }
      ASSERT_NEAR(length(found[i].normal), 1, 1e-6);
    }
  }
}

/// Triangles of all sizes anywhere, some of them needles or without area; points at, near and far from them.
struct Soup {
  TriangleMesh mesh;
  std::vector<Vec3f> points;

  Soup(std::uint64_t seed, int triangles, int points_count, float scale) {
    TriangleRandom r(seed);
    for (int i = 0; i < triangles; ++i) {
      TriangleCase c = adversarial_case(r, scale * (i % 3 == 0 ? 1.0f : 0.1f));
      const Vec3f shift = r.vector() * (scale * 3);
      if (i % 31 == 0) c.corner[2] = c.corner[0] + (c.corner[1] - c.corner[0]) * 0.5f;
      // Two corners, or all, at one place.
      if (i % 37 == 0) c.corner[2] = c.corner[1];
      if (i % 41 == 0) c.corner[1] = c.corner[2] = c.corner[0];
      for (const Vec3f& v : c.corner) {
        mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
        mesh.positions.push_back(v + shift);
      }
    }
    for (int i = 0; i < points_count; ++i) {
      Vec3f p = r.vector() * (scale * 4);
      if (i % 4 == 1) p = mesh.positions[r.below(static_cast<std::uint32_t>(mesh.positions.size()))];
      if (i % 4 == 2) p = (mesh.positions[r.below(99)] + mesh.positions[r.below(99)]) * 0.5f;
      if (i % 64 == 3) p = p * 1e5f;
      points.push_back(p);
    }
  }
};

// On soups of all scales; the greatest have squares that overflow in float, the least some that underflow.
TEST(ClosestPoint, IsThatOfAllTrianglesTried) {
  for (const float scale : {1.0f, 1e-32f, 1e-12f, 1e8f, 1e17f, 1e31f}) {
    const Soup soup(static_cast<std::uint64_t>(std::log10(scale) + 40), 700, 500, scale);
    for (const BuildQuality quality : {BuildQuality::balanced, BuildQuality::best, BuildQuality::compact}) {
      const auto accel = build_accel({{MeshGeometry{&soup.mesh}, {}, kNoId}}, {.quality = quality});
      expect_closest(*accel, soup.points);
      if (HasFatalFailure()) FAIL() << "scale " << scale;
    }
  }
}

/// A ball of triangles about the origin, exactly symmetric.
TriangleMesh ball(int levels) {
  TriangleMesh mesh;
  const auto add = [&](const auto& self, const Vec3f& a, const Vec3f& b, const Vec3f& c, int level) -> void {
    if (level == 0) {
      for (const Vec3f& p : {a, b, c}) {
        mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
        mesh.positions.push_back(p);
      }
      return;
    }
    const auto middle = [](const Vec3f& p, const Vec3f& q) { return normalize(p + q); };
    const Vec3f ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    self(self, a, ab, ca, level - 1), self(self, ab, b, bc, level - 1);
    self(self, ca, bc, c, level - 1), self(self, ab, bc, ca, level - 1);
  };
  for (int octant = 0; octant < 8; ++octant) {
    const Vec3f x{octant & 1 ? -1.0f : 1.0f, 0, 0}, y{0, octant & 2 ? -1.0f : 1.0f, 0},
        z{0, 0, octant & 4 ? -1.0f : 1.0f};
    const bool turned = __builtin_popcount(static_cast<unsigned>(octant)) % 2 == 1;
    add(add, x, turned ? z : y, turned ? y : z, levels);
  }
  return mesh;
}

// From the centre of symmetry, from its planes and axes, and from corners and edges: many triangles are
// equally near, and the lowest item counts.
TEST(ClosestPoint, OfEquallyNearTrianglesTheFirstCounts) {
  const TriangleMesh mesh = ball(4);
  std::vector<Vec3f> points{{0, 0, 0}, {-0.0f, 0, 0}, {5, 0, 0}, {0, -1e-20f, 0}, {1, 1, 1}, {0.5f, 0.5f, 0}};
  for (std::size_t i = 0; i < mesh.positions.size(); i += 7) {
    points.push_back(mesh.positions[i]);
    points.push_back(mesh.positions[i] * 3.0f);
    points.push_back((mesh.positions[i] + mesh.positions[3 * (i / 3) + (i + 1) % 3]) * 0.75f);
  }
  const auto accel = build_accel({{MeshGeometry{&mesh}, {}, kNoId}});
  expect_closest(*accel, points);
  const ClosestPoint centre = closest_point(*accel, {0, 0, 0});
  EXPECT_LT(dot(centre.normal, centre.point), 1.01f);
  EXPECT_GT(dot(centre.normal, centre.point), 0.9f);
}

// Nested instances that scale, shear and mirror: the nearest point in the world is not the image of that in
// the child.
TEST(ClosestPoint, ThroughNestedInstancesOfAnyMap) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const Soup soup(seed, 60, 0, 1), other(seed + 50, 20, 0, 1);
    TriangleRandom r(seed);
    const auto map = [&] {
      Affine m = Affine::rotation(Vec3d(r.vector()) * 180.0);
      m = m *
          Affine::scaling({std::exp2(2.0 * r.sign()), -std::exp2(3.0 * r.sign()), std::exp2(4.0 * r.sign())});
      if (seed % 2 == 1) m = m * Affine::rotation(Vec3d(r.vector()) * 180.0);
      return Affine::translation(Vec3d(r.vector()) * 8.0) * m;
    };
    const auto inner = build_accel({{MeshGeometry{&soup.mesh}, {}, kNoId}});
    std::vector<Geometry> middle_things;
    for (int i = 0; i < 3; ++i) middle_things.push_back({InstanceGeometry{inner}, map(), kNoId});
    middle_things.push_back({MeshGeometry{&other.mesh}, {}, kNoId});
    const auto middle = build_accel(middle_things);
    InstanceList list{{inner, middle}, {}};
    for (std::uint32_t i = 0; i < 6; ++i) {
      InstancePlace place{{}, i % 2, kNoId};
      map().to_rows(place.to_list);
      list.places.push_back(place);
    }
    std::vector<Geometry> things;
    things.push_back({InstanceGeometry{middle}, map(), kNoId});
    things.push_back({MeshGeometry{&other.mesh}, {}, kNoId});
    things.push_back({InstanceGeometry{inner}, {}, kNoId});
    things.push_back({list, Affine{}, kNoId});
    std::vector<Vec3f> points;
    for (int i = 0; i < 200; ++i) points.push_back(r.vector() * (i % 9 == 0 ? 1e6f : 20.0f));
    expect_closest(*build_accel(things), points);
    if (HasFatalFailure()) FAIL() << "seed " << seed;
  }
}

// The normal of a mirrored mesh and of mirrored instances points outwards.
TEST(ClosestPoint, NormalsPointOutwards) {
  const TriangleMesh mesh = ball(3);
  const Affine mirror = Affine::scaling({-1, 2, 3});
  const auto plain = build_accel({{MeshGeometry{&mesh}, {}, kNoId}});
  const auto mirrored = build_accel({{MeshGeometry{&mesh}, mirror, kNoId}});
  const auto instance = build_accel({{InstanceGeometry{plain}, mirror, kNoId}});
  const auto twice = build_accel({{InstanceGeometry{mirrored}, mirror, kNoId}});
  TriangleRandom r(1);
  for (const auto& accel : {plain, mirrored, instance, twice})
    for (int i = 0; i < 100; ++i) {
      const Vec3f p = r.vector() * 5.0f;
      const ClosestPoint c = closest_point(*accel, p);
      EXPECT_GT(dot(c.normal, c.point), 0);
      // The hit of a ray from outside has this normal, too.
      const Ray ray{c.point + c.normal * 2.0f, 0, -c.normal, 10};
      const Hit hit = closest_hit(*accel, ray);
      if (hit.item == c.item) {
        EXPECT_GT(dot(surface_interaction(*accel, ray, hit).geometric_normal, c.normal), 0.9999f);
      }
      EXPECT_EQ(identify(*accel, c.hit()).geometry, 0u);
    }
}

TEST(ClosestPoint, NothingIsNearestToWhatIsNotFinite) {
  const TriangleMesh mesh = ball(1);
  const auto accel = build_accel({{MeshGeometry{&mesh}, {}, kNoId}}), nothing = build_accel({});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Isa isa : available_isas()) {
    for (const Vec3f& p : {Vec3f{nan, 0, 0}, Vec3f{0, kInf, 0}, Vec3f{0, 0, -kInf}, Vec3f{kInf, -kInf, nan}})
      EXPECT_EQ(closest_point(*accel, p, isa), ClosestPoint{});
    EXPECT_EQ(closest_point(*nothing, {1, 2, 3}, isa), ClosestPoint{});
    EXPECT_TRUE(closest_point(*accel, {3e38f, -3e38f, 3e38f}, isa).valid());
  }
}

TEST(ClosestPoint, BatchesOfEverySize) {
  const Soup soup(9, 100, 0, 1);
  const auto accel = build_accel({{MeshGeometry{&soup.mesh}, {}, kNoId}});
  TriangleRandom r(2);
  for (const std::size_t count : {0, 1, 1023, 1024, 1025, 5000}) {
    std::vector<Vec3f> points;
    for (std::size_t i = 0; i < count; ++i) points.push_back(r.vector() * 3.0f);
    std::vector<ClosestPoint> found(count);
    closest_point(*accel, points, found);
    for (std::size_t i = 0; i < count; i += 13) ASSERT_EQ(found[i], closest_point(*accel, points[i]));
  }
  std::vector<Vec3f> points(3);
  std::vector<ClosestPoint> two(2);
  try {
    closest_point(*accel, points, two);
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "closest_point: 3 points, but room for 2 answers");
  }
}

}  // namespace
}  // namespace oktett::closest_point_test
