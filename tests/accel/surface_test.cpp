#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/accel/same_hits.h"
#include "tests/support/limits.h"
#include "verify/cases/kernel_cases.h"
#include "verify/oracles/closed.h"
#include "verify/oracles/mesh.h"

namespace oktett::surface_test {
namespace {

Hit trace(const Accel& accel, const Ray& ray) {
  RayBatch rays;
  rays.push_back(ray);
  HitBatch hits;
  hits.resize_uninitialized(1);
  closest_hit(accel, rays.span(), hits.span(), default_isa());
  return hits[0];
}

Geometry instance(std::shared_ptr<const Accel> child, const Affine& m, std::uint32_t user = kNoId) {
  return {InstanceGeometry{std::move(child)}, m, user};
}

/// All modes and instruction sets give the hits of the scalar code; any_hit and all_hits agree with them.
int expect_agreement(const Accel& accel, const RayBatch& rays) {
  const HitBatch expected = scalar_hits(accel, rays);
  const int count = expect_hits(accel, rays, expected, kTraceModes);
  std::vector<Hit> all;
  for (const Isa isa : available_isas()) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      all_hits(accel, rays[i], all, isa);
      EXPECT_EQ(all.empty(), !expected[i].valid());
      if (!all.empty()) {
        EXPECT_EQ(all[0], expected[i]) << i;
      }
    }
  }
  return count;
}

RayBatch rays_towards_origin(int count, double from, double spread, std::uint64_t seed) {
  RayBatch rays;
  CaseRandom r(seed);
  for (int i = 0; i < count; ++i) {
    const Vec3f o(r.vector() * from);
    rays.push_back({o, 0, Vec3f(r.vector() * spread) - o, kInf});
  }
  return rays;
}

/// One of each shape, with a mesh.
std::vector<Geometry> one_of_each(const TriangleMesh& mesh) {
  PolygonShape star;
  for (int i = 0; i < 10; ++i) {
    const double a = i * 0.628318530717958, s = i % 2 ? 0.4 : 1;
    star.vertices.push_back({s * std::cos(a) - 2, s * std::sin(a), 0.5});
  }
  std::vector<Geometry> g;
  g.push_back({MeshGeometry{&mesh}, Affine::translation({2, 0, 0}) * Affine::rotation({10, 20, 30}), 1});
  g.push_back({SpheresShape{{{{0, 2, 0}, 0.7}, {{0, -2, 0}, 0.5}}}, {}, 2});
  g.push_back({PlaneShape{{0, 1, 0.1}, -3}, {}, 3});
  g.push_back({DiskShape{{0, 0, 2}, {0.2, 0.3, 1}, 0.8}, {}, 4});
  g.push_back({BoxShape{{-0.5, -0.4, -0.3}, {0.5, 0.4, 0.3}}, Affine::rotation({40, 50, 60}), 5});
  g.push_back({star, {}, 6});
  return g;
}

TEST(SurfaceInteraction, MixedKindsAgreeInAllModes) {
  const TriangleMesh mesh = make_icosphere(2).mesh;
  const auto accel = build_accel(one_of_each(mesh));
  EXPECT_GT(expect_agreement(*accel, rays_towards_origin(3000, 8, 3, 1)), 1500);
}

TEST(SurfaceInteraction, PolygonAgreesWithTheOracle) {
  const TriangleMesh mesh = make_cube().mesh;
  const std::vector<Geometry> all = one_of_each(mesh);
  const PolygonShape star = std::get<PolygonShape>(all[5].shape);
  const auto accel = build_accel({all[5]});
  CaseRandom r(9);
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3f o(r.vector() * 4.0);
    const Vec3d target = i % 3 == 0 ? star.vertices[r.bits() % 10] : Vec3d{-2, 0, 0.5} + r.vector();
    const Ray ray{o, 0, Vec3f(target) - o, kInf};
    const OracleAnswer truth = oracle_polygon(ray, star);
    if (truth.verdict == OracleVerdict::undecided) continue;
    const Hit hit = trace(*accel, ray);
    ASSERT_EQ(hit.valid(), truth.verdict == OracleVerdict::hit) << i;
    hits += hit.valid();
    if (hit.valid()) {
      ASSERT_NEAR(hit.t, truth.t, 1e-7 * truth.t + truth.t_error);
    }
  }
  EXPECT_GT(hits, 3000);
}

/// The hit point lies within its error bound of the ray, and a ray that leaves from there meets nothing
/// nearby.
void expect_good_surfaces(const Accel& accel, const RayBatch& rays) {
  CaseRandom r(77);
  int hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray ray = rays[i];
    const Hit hit = trace(accel, ray);
    if (!hit.valid()) continue;
    ++hits;
    const SurfaceInteraction s = surface_interaction(accel, ray, hit);
    ASSERT_NEAR(length(s.geometric_normal), 1, 1e-5) << i;
    ASSERT_NEAR(length(s.shading_normal), 1, 1e-5) << i;
    const double slope = std::abs(dot(s.geometric_normal, ray.direction)) / length(ray.direction);
    if (slope < 0.01) continue;
    // Along the normal the point must be right; along the surface it may slide with the rounding of t.
    const Vec3d off = Vec3d(s.position) - (Vec3d(ray.origin) + Vec3d(ray.direction) * double(hit.t));
    const double bound = (length(Vec3d(s.position_error)) + 2e-7 * hit.t * length(ray.direction)) * 2;
    ASSERT_LE(length(off), bound / slope) << i;
    const Vec3f n = s.geometric_normal, to_light(r.vector());
    const float side = dot(n, to_light) > 0 ? 1.0f : -1.0f;
    // Straight away from the surface nothing may be met within a thousand error bounds.
    const float clear = 1000 * max_component(s.position_error);
    const Ray leaving{offset_origin(s, n * side), 0, n * side, clear};
    const Hit again = trace(accel, leaving);
    ASSERT_FALSE(again.valid() && again.item == hit.item && again.instance == hit.instance) << i;
  }
  EXPECT_GT(hits, static_cast<int>(rays.size() / 3));
}

TEST(SurfaceInteraction, ShapesNeitherShadowThemselvesNorStray) {
  const TriangleMesh mesh = make_icosphere(2).mesh;
  expect_good_surfaces(*build_accel(one_of_each(mesh)), rays_towards_origin(3000, 8, 3, 2));
}

TEST(SurfaceInteraction, MeshesAtAllScalesNeitherShadowThemselvesNorStray) {
  for (const double scale : {1e-6, 1.0, 1e6, 1e12}) {
    const TriangleMesh mesh = placed(make_torus(24, 16).mesh, scale, {0, 0, 0});
    const auto accel = build_accel({{MeshGeometry{&mesh}, {}, kNoId}});
    expect_good_surfaces(*accel, rays_towards_origin(1500, 4 * scale, scale, 3));
  }
  const TriangleMesh far = placed(make_torus(24, 16).mesh, 100, {148376, 1234, -223423});
  const auto accel = build_accel({{MeshGeometry{&far}, {}, kNoId}});
  RayBatch rays = rays_towards_origin(1500, 400, 100, 4), moved;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Ray ray = rays[i];
    ray.origin += Vec3f{148376, 1234, -223423};
    moved.push_back(ray);
  }
  expect_good_surfaces(*accel, moved);
}

/// A square in the plane y = 0 of side 2 `half`, as two triangles whose corners are listed from `first` on;
/// its front is above or below.
TriangleMesh ground(float half, std::uint32_t first, bool above) {
  TriangleMesh mesh;
  for (const Vec3f& p : {Vec3f{-1, 0, -1}, Vec3f{-1, 0, 1}, Vec3f{1, 0, 1}, Vec3f{1, 0, -1}})
    mesh.positions.push_back(p * half);
  for (const std::uint32_t k : {0u, above ? 1u : 2u, above ? 2u : 1u, 0u, above ? 2u : 3u, above ? 3u : 2u})
    mesh.indices.push_back((first + k) % 4);
  return mesh;
}

/// Rays that leave a face in the plane y = 0 upwards, up to grazing ones, meet nothing. There the coordinates
/// have no rounding errors, so only the errors of the intersection test itself are left.
void expect_free_above_ground(const Geometry& geometry, double half, const char* name) {
  const auto accel = build_accel({geometry});
  CaseRandom r(31);
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3d target{half * 0.9 * r.sign(), 0, half * 0.9 * r.sign()};
    const Vec3d from{2 * half * r.sign(), half * (0.01 + 2 * r.unit()), 2 * half * r.sign()};
    const Ray ray{Vec3f(from), 0, Vec3f(target) - Vec3f(from), kInf};
    const Hit hit = trace(*accel, ray);
    if (!hit.valid()) continue;
    ++hits;
    const SurfaceInteraction s = surface_interaction(*accel, ray, hit);
    if (std::abs(s.geometric_normal.y) < 0.999f) continue;  // another face
    const double slope = i % 2 == 0 ? 0.01 + r.unit() : r.magnitude(-5, 0);
    const Vec3f leaving(Vec3d{r.sign(), slope, r.sign()});
    const Hit again = trace(*accel, {offset_origin(s, leaving), 0, leaving, kInf});
    ASSERT_FALSE(again.valid()) << name << " of half side " << half << ", ray " << i << ", t " << again.t;
  }
  EXPECT_GT(hits, 10000) << name;
}

TEST(SurfaceInteraction, LargeFacesInCoordinatePlanesDoNotShadowThemselves) {
  for (const double half : {1e-4, 1.0, 20.0, 1e6}) {
    for (std::uint32_t first = 0; first < 4; ++first)
      for (const bool above : {true, false}) {
        const TriangleMesh mesh = ground(static_cast<float>(half), first, above);
        expect_free_above_ground({MeshGeometry{&mesh}, {}, kNoId}, half, "mesh");
        if (HasFailure()) return;
      }
    expect_free_above_ground({PlaneShape{{0, 1, 0}, 0}, {}, kNoId}, half, "plane");
    expect_free_above_ground({DiskShape{{0, 0, 0}, {0, 1, 0}, half}, {}, kNoId}, half, "disk");
    expect_free_above_ground({BoxShape{{-half, -half, -half}, {half, 0, half}}, {}, kNoId}, half, "box");
    expect_free_above_ground(
        {PolygonShape{{{-half, 0, -half}, {-half, 0, half}, {half, 0, half}, {half, 0, -half}}}, {}, kNoId},
        half, "polygon");
    expect_free_above_ground({ExactShape{CylinderShape{{0, -half, 0}, {0, 0, 0}, half}}, {}, kNoId}, half,
                             "cylinder");
    expect_free_above_ground({ExactShape{ConeShape{{0, -half, 0}, {0, 0, 0}, 2 * half, half}}, {}, kNoId},
                             half, "cone");
    expect_free_above_ground({ExactShape{PolyhedronShape{{{{0, 1, 0}, 0},
                                                          {{0, -1, 0}, half},
                                                          {{1, 0, 0}, half},
                                                          {{-1, 0, 0}, half},
                                                          {{0, 0, 1}, half},
                                                          {{0, 0, -1}, half}}}},
                              {},
                              kNoId},
                             half, "polyhedron");
    QuadricShape bowl{{1, 1, 1, 0, 0, 0, 0, 0, 0, -4 * half * half}};
    bowl.clipped = true, bowl.lo = {-half, -half, -half}, bowl.hi = {half, 0, half};
    expect_free_above_ground({ExactShape{bowl}, {}, kNoId}, half, "quadric");
  }
}

TEST(Instance, NestedScaledAndMirroredAgreeInAllModes) {
  const TriangleMesh mesh = make_icosphere(2).mesh;
  const auto leaf = build_accel(one_of_each(mesh));
  const auto middle =
      build_accel({instance(leaf, Affine::scaling({0.3, 0.5, -0.4})),
                   instance(leaf, Affine::translation({4, 0, 0}) * Affine::rotation({0, 33, 0})),
                   {SpheresShape{{{{0, 0, 3}, 1}}}, Affine::scaling({1, 2, 0.5}), 9}});
  const auto top = build_accel(
      {instance(middle, Affine::rotation({10, 20, 30}), 42), instance(middle, Affine::scaling({1, 0, 1})),
       instance(middle, Affine::translation({0, 5, 0}) * Affine::scaling({-1, 1, 1}))});
  const RayBatch rays = rays_towards_origin(1500, 20, 6, 5);
  EXPECT_GT(expect_agreement(*top, rays), 700);
  expect_good_surfaces(*top, rays);
}

TEST(Instance, OutermostUserNumberWins) {
  const auto leaf = build_accel({{SpheresShape{{{{0, 0, 0}, 1}}}, {}, 7}});
  const Ray ray{{0, 0, 5}, 0, {0, 0, -1}, kInf};
  const auto named = build_accel({instance(build_accel({instance(leaf, {}, 8)}), {}, 9)});
  EXPECT_EQ(surface_interaction(*named, ray, trace(*named, ray)).user, 9u);
  const auto plain = build_accel({instance(build_accel({instance(leaf, {}, 8)}), {})});
  EXPECT_EQ(surface_interaction(*plain, ray, trace(*plain, ray)).user, 8u);
  const auto bare = build_accel({instance(leaf, {})});
  EXPECT_EQ(surface_interaction(*bare, ray, trace(*bare, ray)).user, 7u);
}

TEST(Instance, SingularTransformsAreLeftOut) {
  const auto leaf = build_accel({{SpheresShape{{{{0, 0, 0}, 1}}}, {}, 7}});
  const auto flat = build_accel({instance(leaf, Affine::scaling({1, 0, 1}))});
  EXPECT_TRUE(bounds(*flat).empty());
  EXPECT_FALSE(trace(*flat, {{0, 0, 5}, 0, {0, 0, -1}, kInf}).valid());
}

InstancePlace listed(const Affine& m, std::uint32_t child, std::uint32_t user = kNoId) {
  InstancePlace place{{}, child, user};
  m.to_rows(place.to_list);
  return place;
}

/// Maps that floats hold exactly, and their inverses, too.
std::vector<Affine> dyadic_maps() {
  return {Affine::translation({4, 0, 0}) * Affine::scaling({0.5, 0.25, -1}),
          Affine::translation({0, -4, 2}) * Affine::scaling({-1, 2, 1}), Affine::translation({0, 5, 0}),
          Affine::scaling({0.5, 0.5, 0.5}), Affine::translation({-4, 0.5, 0})};
}

// One geometry with many instances in it gives the hits of as many geometries.
TEST(InstanceList, LikeInstancesOneByOne) {
  const TriangleMesh mesh = make_icosphere(2).mesh;
  std::vector<Geometry> shapes = one_of_each(mesh);
  const auto leaf = build_accel(shapes);
  const auto nested = build_accel({instance(leaf, Affine::scaling({0.5, 0.5, 0.5}), 3)});
  std::vector<Geometry> alone{{SpheresShape{{{{0, 0, 3}, 1}}}, {}, 1}}, together = alone;
  InstanceList list{{leaf, nested}, {}};
  for (std::uint32_t k = 0; k < dyadic_maps().size(); ++k) {
    const Affine m = dyadic_maps()[k];
    alone.push_back(instance(k % 2 == 0 ? leaf : nested, m, k == 2 ? kNoId : 10 + k));
    list.places.push_back(listed(m, k % 2, k == 2 ? kNoId : 10 + k));
  }
  together.push_back({list, {}, kNoId});
  alone.push_back({SpheresShape{{{{0, 3, 3}, 1}}}, {}, 2}), together.push_back(alone.back());
  const auto a = build_accel(alone), b = build_accel(together);
  const RayBatch rays = rays_towards_origin(1500, 20, 6, 5);
  EXPECT_GT(expect_agreement(*b, rays), 700);
  expect_good_surfaces(*b, rays);
  HitBatch one, two;
  one.resize_uninitialized(rays.size()), two.resize_uninitialized(rays.size());
  closest_hit(*a, rays.span(), one.span(), default_isa());
  closest_hit(*b, rays.span(), two.span(), default_isa());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(one[i].valid(), two[i].valid());
    if (!one[i].valid()) continue;
    ASSERT_EQ(one[i].t, two[i].t);
    ASSERT_EQ(one[i].item, two[i].item);
    const SurfaceInteraction s = surface_interaction(*a, rays[i], one[i]),
                             t = surface_interaction(*b, rays[i], two[i]);
    ASSERT_EQ(s.user, t.user);
    ASSERT_EQ(s.position, t.position);
    ASSERT_EQ(s.geometric_normal, t.geometric_normal);
  }
}

// What is traced is what the floats say, to the last bit and in every mode.
TEST(InstanceList, TurnedAndNested) {
  const TriangleMesh mesh = make_icosphere(2).mesh;
  const auto leaf = build_accel(one_of_each(mesh));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto some = [&](double far) {
    std::vector<InstancePlace> places;
    for (std::uint32_t k = 0; k < 12; ++k)
      places.push_back(listed(Affine::translation(Vec3d{u(random), u(random), u(random)} * far) *
                                  Affine::rotation(Vec3d{u(random), u(random), u(random)} * 180.0) *
                                  Affine::scaling({0.3, 0.2 + 0.1 * u(random), -0.3}),
                              0, k % 3 == 0 ? k : kNoId));
    return places;
  };
  const auto middle = build_accel({{InstanceList{{leaf}, some(3)}, Affine::scaling({1, 0.5, 1}), kNoId}});
  const auto top = build_accel({{InstanceList{{middle}, some(4)}, {}, kNoId}});
  const RayBatch rays = rays_towards_origin(500, 20, 6, 5);
  EXPECT_GT(expect_agreement(*top, rays), 150);
  expect_good_surfaces(*top, rays);
}

TEST(InstanceList, LeavesOutWhatCannotBeShown) {
  const auto leaf = build_accel({{SpheresShape{{{{0, 0, 0}, 1}}}, {}, 7}});
  const auto floor = build_accel({{PlaneShape{{0, 0, 1}, -3}, {}, 8}});
  const Ray ray{{0, 0, 5}, 0, {0, 0, -1}, kInf};
  InstanceList list{{leaf, floor},
                    {listed(Affine::scaling({1, 0, 1}), 0), listed({}, 2),
                     listed(Affine::translation({std::nan(""), 0, 0}), 0)}};
  EXPECT_FALSE(trace(*build_accel({{list, {}, kNoId}}), ray).valid());
  list.places.push_back(listed(Affine::translation({0, 0, 1}), 1));
  const auto accel = build_accel({{list, {}, 5}});
  const Hit hit = trace(*accel, ray);
  EXPECT_EQ(hit.t, 7);
  EXPECT_EQ(hit.item, 0u);
  EXPECT_EQ(surface_interaction(*accel, ray, hit).user, 5u);
  EXPECT_FALSE(trace(*build_accel({{InstanceList{}, {}, kNoId}}), ray).valid());
}

// A mirrored mesh still points outwards, and t means the same inside an instance.
TEST(Instance, NormalsPointOutwardsAndDistancesStay) {
  const TriangleMesh mesh = make_icosphere(3).mesh;
  const auto leaf = build_accel({{MeshGeometry{&mesh}, {}, kNoId}});
  const Affine m = Affine::translation({3, 0, 0}) * Affine::scaling({-2, 2, 2});
  const auto accel =
      build_accel({instance(leaf, m), {MeshGeometry{&mesh}, Affine::scaling({1, -1, 1}), kNoId}});
  for (const Ray ray :
       {Ray{{3.1f, 0.2f, 9}, 0, {0, 0, -0.5f}, kInf}, Ray{{0.1f, 0.2f, 9}, 0, {0, 0, -0.5f}, kInf}}) {
    const Hit hit = trace(*accel, ray);
    ASSERT_TRUE(hit.valid());
    const SurfaceInteraction s = surface_interaction(*accel, ray, hit);
    EXPECT_GT(s.geometric_normal.z, 0.8f);
    EXPECT_NEAR(ray.origin.z - 0.5f * hit.t, s.position.z, 1e-5f);
  }
}

}  // namespace
}  // namespace oktett::surface_test
