/// \file The checks of whole scenes find what is wrong, and nothing where all is well.

#include <gtest/gtest.h>

#include "verify/cases/kernel_cases.h"
#include "verify/checks/endless.h"
#include "verify/checks/scenes.h"
#include "verify/oracles/known_shapes.h"

namespace oktett::scenes_test {
namespace {

TEST(Scenes, RandomScenesAreRight) {
  const SceneTally t = verify_scenes(32, available_isas());
  EXPECT_EQ(t.wrong(), 0u) << t.failure;
  EXPECT_EQ(t.scenes, 32u);
  EXPECT_GT(t.hits, t.rays / 8);
  EXPECT_GT(t.compared, 1000u);
  EXPECT_GT(t.kinds.size(), known_kinds().size() / 2);
}

/// A patch in nested instances is hit next to a fold, where the line of the ray in the world finds another
/// crossing.
TEST(Scenes, HitsNextToFoldsLieOnTheirRays) {
  const SceneTally t = verify_scenes(1, available_isas(), 7845142906766215778u);
  EXPECT_EQ(t.wrong(), 0u) << t.failure;
}

/// A known shape that stands elsewhere than its oracle believes.
TEST(Scenes, OraclesOfEveryKindFindALie) {
  for (std::size_t kind = 0; kind < known_kinds().size(); ++kind) {
    std::uint64_t untrue = 0;
    bool has_oracle = false;
    for (std::uint64_t number = 0; number < 4 && untrue == 0; ++number) {
      Scene scene;
      Object& object = scene.objects.emplace_back();
      object.shape = draw_known_shape(kind, number).shape;
      // The oracle is that of another number.
      object.name = known_name(kind, number + 100);
      const auto known = known_shape(object.name);
      ASSERT_TRUE(known.has_value());
      has_oracle |= known->truth.f != nullptr;
      untrue += check_scene(scene, draw_rays(scene, number), {Isa::scalar}).untrue;
    }
    // Some forms are the same for all numbers.
    static const std::set<std::string> kFixed = {"polynomial_barth", "polynomial_chmutov",
                                                 "infinite_cylinder", "paraboloid", "menger"};
    if (kFixed.contains(known_kinds()[kind])) continue;
    EXPECT_EQ(untrue > 0, has_oracle) << known_kinds()[kind];
  }
}

/// Sturm chains that run out of digits must not become hits, nor holes.
TEST(Scenes, SturmChainsAreAsRightAsOtherFinders) {
  int kinds = 0;
  for (std::size_t kind = 0; kind < known_kinds().size(); ++kind) {
    const std::string& name = known_kinds()[kind];
    if (!name.starts_with("blob") && !name.starts_with("polynomial")) continue;
    ++kinds;
    for (std::uint64_t number = 0; number < 4; ++number) {
      Scene scene;
      Object& object = scene.objects.emplace_back();
      object.shape = draw_known_shape(kind, number).shape;
      object.name = known_name(kind, number);
      std::visit(
          [](auto& form) {
            if constexpr (requires { form.root_finder; }) form.root_finder = roots::Method::sturm;
          },
          std::get<ExactShape>(object.shape).form);
      const SceneTally tally = check_scene(scene, draw_rays(scene, number), {Isa::scalar});
      EXPECT_EQ(tally.wrong(), 0u) << name << " " << number << ": " << tally.failure;
    }
  }
  EXPECT_GE(kinds, 4);
}

/// A sphere with unequal scales is an instance, in which the ray is rounded to float: that displaces this
/// hit, at a slant, by more than rounding t does.
TEST(Scenes, RoundedRaysMeetSurfacesElsewhere) {
  Scene scene;
  Object& object = scene.objects.emplace_back();
  object.name = "sphere.8657362093165023979";
  object.shape = known_shape(object.name)->shape;
  const double rows[] = {-995134.969146509,   -77807.16055627544, 1089209.4579791063,  2198889.232767953,
                         818890.1892910454,   329657.5160203874,  1287839.0169276358,  273252.36372209055,
                         -173106.70832802908, 2006750.2604025323, -169327.25655156927, 1502058.8241450356};
  object.transform = Affine::from_rows(rows);
  Ray ray{{-0x1.0a1a0ap+21f, -0x1.9e3f14p+21f, 0x1.0fc932p+18f},
          0x1.c13a68p-3f,
          {0x1.34d41p+22f, 0x1.5b2256p+21f, 0x1.2ed242p+20f}};
  RayBatch rays;
  rays.push_back(ray);
  const SceneTally right = check_scene(scene, rays, {Isa::scalar});
  EXPECT_EQ(right.hits, 1u);
  EXPECT_EQ(right.wrong(), 0u) << right.failure;
  // The same ray at a sphere that is a little larger than its name says.
  std::get<SphereShape>(object.shape).radius *= 1 + 1e-5;
  EXPECT_GT(check_scene(scene, rays, {Isa::scalar}).untrue, 0u);
}

/// Rays through the missing disks of open profiles and just past their rims. They come from so far away that
/// rounding t to float moves a point by up to a thousandth.
TEST(Scenes, OpenProfilesEndAtTheirRims) {
  int open = 0;
  for (std::uint64_t number = 0; number < 64; ++number) {
    Scene scene;
    Object& object = scene.objects.emplace_back();
    object.name = "lathe." + std::to_string(number);
    object.shape = known_shape(object.name)->shape;
    const auto& shape = std::get<LatheShape>(std::get<ExactShape>(object.shape).form);
    if (!shape.open) continue;
    ++open;
    object.transform = Affine::rotation({10, 20, 30});
    CaseRandom random(number);
    RayBatch rays;
    for (int i = 0; i < 2048; ++i) {
      const ProfilePoint& end = i % 2 == 0 ? shape.points.front() : shape.points.back();
      const double rho = end.radius * 1.2 * random.unit(), angle = 6.283185307179586 * random.unit();
      const Vec3d at{rho * std::cos(angle), end.height, rho * std::sin(angle)};
      const Vec3d side{random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5};
      const Vec3f from(object.transform.point(at + side * std::exp2(2 + 12 * random.unit())));
      rays.push_back({from, 0, Vec3f(object.transform.point(at)) - from});
    }
    const SceneTally tally = check_scene(scene, rays, {Isa::scalar});
    EXPECT_EQ(tally.wrong(), 0u) << object.name << ": " << tally.failure;
  }
  EXPECT_GT(open, 2);
}

TEST(KnownShapes, HaveNames) {
  EXPECT_TRUE(known_shape("torus.12").has_value());
  for (const char* name : {"torus", "torus.", "torus.x", "torus.1 ", "nothing.1", ""})
    EXPECT_FALSE(known_shape(name).has_value()) << name;
}

/// The first round holds something of everything; the same seed gives the same cases.
TEST(Endless, CoversEverything) {
  EndlessOptions options;
  options.isas = {Isa::scalar};
  options.seconds = 0;
  EXPECT_EQ(verify_endless(options, {}).rays(), 0u);
  options.seconds = 1;
  const Coverage c = verify_endless(options, {});
  EXPECT_EQ(c.wrong(), 0u);
  EXPECT_GT(c.rays(), 0u);
  ASSERT_EQ(c.rows.size(), 8u);
  EXPECT_EQ(c.rows[0].of, 88u);
}

}  // namespace
}  // namespace oktett::scenes_test
