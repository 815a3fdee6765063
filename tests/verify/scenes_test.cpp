/// \file The checks of whole scenes find what is wrong, and nothing where all is well.

#include <gtest/gtest.h>

#include "verify/checks/endless.h"
#include "verify/checks/scenes.h"
#include "verify/oracles/known_shapes.h"
#include "verify/oracles/random_scene.h"

namespace oktett {
namespace {

TEST(Scenes, RandomScenesAreRight) {
  const SceneTally t = verify_scenes(32, available_isas());
  EXPECT_EQ(t.wrong(), 0u) << t.failure;
  EXPECT_EQ(t.scenes, 32u);
  EXPECT_GT(t.hits, t.rays / 8);
  EXPECT_GT(t.compared, 1000u);
  EXPECT_GT(t.kinds.size(), known_kinds().size() / 2);
}

/// A known shape that stands elsewhere than its oracle believes.
TEST(Scenes, OraclesOfEveryKindFindALie) {
  for (std::size_t kind = 0; kind < known_kinds().size(); ++kind) {
    std::uint64_t untrue = 0;
    bool has_oracle = false;
    for (std::uint64_t number = 0; number < 4; ++number) {
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
  for (std::size_t kind = 0; kind < known_kinds().size(); ++kind) {
    const std::string& name = known_kinds()[kind];
    if (!name.starts_with("blob") && !name.starts_with("polynomial")) continue;
    for (std::uint64_t number = 0; number < 6; ++number) {
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
  ASSERT_EQ(c.rows.size(), 5u);
  EXPECT_EQ(c.rows[0].of, 80u);
}

}  // namespace
}  // namespace oktett
