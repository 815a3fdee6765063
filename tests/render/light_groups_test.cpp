/// \file Layers of light groups. Lamps of the groups red, green and blue have one colour channel each, and no
/// surface turns one channel into another. So the channel of a group in its layer is that of the picture, and
/// its other channels are black.

#include "render/light_groups.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/error.h"
#include "render/photon/photon_map.h"
#include "tests/render/test_scenes.h"

namespace oktett::light_groups_test {
namespace {

using namespace test;

constexpr const char* kNames[] = {"red", "green", "blue"};
constexpr Color kColors[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr const char* kChannels[] = {"R", "G", "B"};

void add_light(Scene& scene, Light light, const std::string& group) {
  scene.lights.push_back(std::move(light));
  scene.light_traits.resize(scene.lights.size());
  scene.light_traits.back().group = group;
}

std::uint32_t add_lamp_material(Scene& scene, const Color& radiance, const std::string& group) {
  Material m = glowing(radiance);
  m.light_group = group;
  return add_material(scene, m);
}

/// Grey balls, a mirror and glass on a floor.
Scene things(std::uint32_t samples = 8) {
  Scene scene = bare_scene(12);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = samples, scene.integrator.depth = 4;
  scene.camera.from = {0, 1.5, 6}, scene.camera.at = {0, 0.5, 0}, scene.camera.fov = 40;
  add_object(scene, PlaneShape{{0, 1, 0}, 0}, add_material(scene, diffuse({0.5f, 0.5f, 0.5f})));
  add_object(scene, SphereShape{{-1.2, 0.6, 0}, 0.6}, add_material(scene, mirror()));
  add_object(scene, SphereShape{{1.2, 0.6, 0}, 0.6}, add_material(scene, glass(1.5f)));
  Material rough = diffuse({0.7f, 0.7f, 0.7f});
  rough.principled = principled_like(rough);
  add_object(scene, BoxShape{{-0.3, 0, -1}, {0.3, 1, -0.5}}, add_material(scene, rough));
  return scene;
}

/// A picture of one pixel that is the same everywhere.
EnvironmentLight even_environment(const Color& radiance) {
  auto picture = std::make_shared<EnvironmentPicture>();
  picture->width = picture->height = 1, picture->pixels = {radiance};
  return EnvironmentLight{picture};
}

/// All kinds of lights, one after the other in red, green and blue; several kinds a group.
Scene all_lights(std::uint32_t samples = 8) {
  Scene scene = things(samples);
  add_light(scene, PointLight{{2, 3, 2}, kColors[0] * 3.0f, true}, kNames[0]);
  add_light(scene, SpotLight{{-2, 4, 1}, {0.5, -1, 0}, kColors[1] * 9.0f}, kNames[1]);
  add_light(scene, DirectionalLight{{1, -1, -1}, kColors[2]}, kNames[2]);
  add_light(scene, DirectionalLight{{-1, -2, -1}, kColors[0] * 2.0f, 5}, kNames[0]);
  add_light(scene, even_environment(kColors[1] * 0.2f), kNames[1]);
  add_light(scene, even_environment(kColors[2] * 0.3f), kNames[2]);
  add_object(scene, SphereShape{{0, 2.5, -1}, 0.2}, add_lamp_material(scene, kColors[2] * 8.0f, kNames[2]));
  add_object(scene, PolygonShape{{{-3, 1, -2}, {-2, 1, -2}, {-2, 2, -2}, {-3, 2, -2}}},
             add_lamp_material(scene, kColors[0] * 4.0f, kNames[0]));
  add_object(scene, DiskShape{{3, 2, -2}, {-1, 0, 0.5}, 0.4},
             add_lamp_material(scene, kColors[1] * 5.0f, kNames[1]));
  // A box is not sampled as a lamp.
  add_object(scene, BoxShape{{-0.5, 0, 1}, {-0.2, 0.3, 1.3}},
             add_lamp_material(scene, kColors[0] * 2.0f, kNames[0]));
  return scene;
}

std::string layer(const std::string& group, const char* channel) { return "light_" + group + "." + channel; }

/// Each layer shows its channel of the picture, which is lit in each.
void expect_channels(const Picture& p) {
  double light[3] = {};
  for (std::uint32_t y = 0; y < p.height; ++y)
    for (std::uint32_t x = 0; x < p.width; ++x)
      for (int group = 0; group < 3; ++group)
        for (int k = 0; k < 3; ++k) {
          const float got = value(p, layer(kNames[group], kChannels[k]).c_str(), x, y);
          const float want = group == k ? value(p, kChannels[k], x, y) : 0;
          ASSERT_NEAR(got, want, 1e-5f * want) << kNames[group] << kChannels[k] << x << ' ' << y;
          light[k] += static_cast<double>(got);
        }
  for (const double sum : light) EXPECT_GT(sum, 0.1);
}

TEST(LightGroups, EachLayerHasTheLightOfItsGroup) {
  expect_channels(run(all_lights()).picture);
  // Textures make hits shaded one by one.
  Scene scene = all_lights();
  Texture checker;
  checker.pattern = PatternTexture{};
  scene.textures.push_back(checker);
  scene.materials[0].color_texture = 0;
  expect_channels(run(scene).picture);
}

TEST(LightGroups, HoldInAdaptiveSamplingAndUnderAClamp) {
  Scene scene = all_lights();
  scene.integrator.error = 0.05, scene.integrator.max_samples = 64;
  const Picture adaptive = run(scene).picture;
  expect_channels(adaptive);
  EXPECT_NE(id(adaptive, "sampleCount.I", 0, 0), 0u);
  scene.integrator.clamp = 0.3;
  expect_channels(run(scene).picture);
}

TEST(LightGroups, HoldWhileThingsMove) {
  Scene scene = all_lights();
  const auto motion = std::make_shared<Motion>();
  motion->factors.push_back({{0, {}}, {1, Affine::translation({1, 0, 0})}});
  scene.light_traits[0].motion = motion;
  scene.objects[4].motion = motion;
  expect_channels(run(scene).picture);
  scene.integrator.caustics.photons = 5000, scene.integrator.caustics.passes = 2;
  expect_channels(run(scene).picture);
}

TEST(LightGroups, HoldInMedia) {
  Scene scene = all_lights();
  Medium fog;
  fog.scattering = {0.1f, 0.1f, 0.1f};
  scene.media.push_back(fog);
  scene.medium = 0;
  scene.objects.erase(scene.objects.begin());  // a plane would have no outside
  expect_channels(run(scene).picture);
  scene.integrator.caustics.photons = 5000, scene.integrator.caustics.passes = 2;
  expect_channels(run(scene).picture);
}

TEST(LightGroups, PhotonsKnowTheirs) {
  Scene scene = all_lights(4);
  scene.integrator.caustics.photons = 20000, scene.integrator.caustics.passes = 2;
  const RenderResult result = run(scene, [](RenderOptions& o) { o.keep_photons = true; });
  expect_channels(result.picture);
  std::size_t of_group[4] = {};
  for (const PhotonPass& pass : result.photons->passes)
    for (const Photon& photon : pass.photons()) ++of_group[photon.light_group];
  EXPECT_EQ(of_group[0], 0u);
  for (int group = 1; group < 4; ++group) EXPECT_GT(of_group[group], 100u) << group;
  // The map is for these groups only: other numbers would stand for other layers.
  const auto again = [&](RenderOptions& o) { o.photons = result.photons; };
  EXPECT_TRUE(same_bytes(run(scene, again).picture, result.picture));
  std::swap(scene.light_traits[0].group, scene.light_traits[1].group);
  EXPECT_THROW(run(scene, again), Error);
}

/// The same scene with the lights of one group alone, 0 being those without a name.
Scene alone(const Scene& scene, const std::string& group) {
  Scene only = scene;
  only.lights.clear(), only.light_traits.clear();
  for (std::size_t i = 0; i < scene.lights.size(); ++i)
    if (scene.light_traits[i].group == group) add_light(only, scene.lights[i], group);
  for (Material& m : only.materials)
    if (m.light_group != group) m.emission = {0, 0, 0};
  if (!group.empty()) only.background = {0, 0, 0};
  return only;
}

double mean(const Picture& p, const std::string& plane) {
  double sum = 0;
  for (const float x : p.find(plane)->values) sum += static_cast<double>(x);
  return sum / static_cast<double>(p.find(plane)->values.size());
}

// Lamps that are seen and mirrored, and nothing that light samples could change: the same bits.
TEST(LightGroups, SeenLampsAreThoseOfAPictureOfTheirGroupAlone) {
  Scene scene = all_lights();
  scene.background = {0.25f, 0.5f, 0.125f};
  scene.lights.erase(scene.lights.begin(), scene.lights.begin() + 3);
  scene.light_traits.erase(scene.light_traits.begin(), scene.light_traits.begin() + 3);
  for (Material& m : scene.materials)
    if (m.reflection == 0 && m.transparency == 0) m.color = {0, 0, 0}, m.diffuse = 0, m.principled.reset();
  const Picture all = run(scene).picture;
  for (const std::string group : {"", "red", "green", "blue"}) {
    const Picture one = run(alone(scene, group)).picture;
    const std::string name = group.empty() ? kDefaultLightGroup : group;
    for (const char* channel : kChannels) {
      const Column<float>&got = all.find(layer(name, channel))->values, &want = one.find(channel)->values;
      for (std::size_t i = 0; i < want.size(); ++i)
        ASSERT_NEAR(got[i], want[i], 1e-6f * want[i]) << name << channel << i;
    }
  }
}

TEST(LightGroups, LayersAreThePicturesOfTheirGroupsAloneButForNoise) {
  Scene scene = all_lights(1024);
  scene.background = {0.1f, 0.1f, 0.1f};
  // Colours that mix, so that the groups differ in more than channels.
  for (std::size_t i = 0; i < scene.lights.size(); ++i)
    if (auto* point = std::get_if<PointLight>(&scene.lights[i])) point->color = {1, 2, 3};
  const Picture all = run(scene).picture;
  for (const std::string group : {"", "red", "green", "blue"}) {
    const Picture one = run(alone(scene, group)).picture;
    const std::string name = group.empty() ? kDefaultLightGroup : group;
    for (const char* channel : kChannels) {
      const double want = mean(one, channel);
      EXPECT_NEAR(mean(all, layer(name, channel)), want, 0.01 * want) << name << channel;
    }
  }
}

TEST(LightGroups, TheSumOfAllLayersIsThePicture) {
  Scene scene = all_lights();
  scene.background = {0.1f, 0.2f, 0.3f};
  // Mixed colours, a sky with its sun, and lights without a group.
  add_light(scene, SkyLight{}, "sky");
  add_light(scene, PointLight{{0, 5, 0}, {4, 5, 6}, true}, "");
  for (Material& m : scene.materials)
    if (!m.light_group.empty()) m.emission += Color{1, 2, 3};
  const Picture p = run(scene).picture;
  for (const char* channel : kChannels)
    for (std::uint32_t y = 0; y < p.height; ++y)
      for (std::uint32_t x = 0; x < p.width; ++x) {
        float sum = 0;
        for (const char* name : {"default", "red", "green", "blue", "sky"})
          sum += value(p, layer(name, channel).c_str(), x, y);
        ASSERT_NEAR(sum, value(p, channel, x, y), 2e-5f * sum) << channel;
      }
}

TEST(LightGroups, ChangeNoOtherLayerAndAreThereOnDemandOnly) {
  const Scene with = all_lights();
  Scene without = with;
  without.light_traits.clear();
  for (Material& m : without.materials) m.light_group.clear();
  const Picture grouped = run(with).picture, plain = run(without).picture;
  for (const PicturePlane& plane : plain.planes) {
    EXPECT_FALSE(plane.name.starts_with("light_"));
    const PicturePlane* other = grouped.find(plane.name);
    ASSERT_NE(other, nullptr);
    EXPECT_TRUE(std::equal(plane.values.begin(), plane.values.end(), other->values.begin())) << plane.name;
    EXPECT_TRUE(std::equal(plane.ids.begin(), plane.ids.end(), other->ids.begin())) << plane.name;
  }
  EXPECT_EQ(grouped.planes.size(), plain.planes.size() + 12);
  EXPECT_EQ(run(with, [](RenderOptions& o) { o.data_layers = false; }).picture.planes.size(), 4u);
  Scene whitted = with;
  whitted.integrator.kind = IntegratorKind::whitted;
  EXPECT_EQ(run(whitted).picture.find("light_red.R"), nullptr);
}

TEST(LightGroups, DependNeitherOnThreadsNorTilesNorSets) {
  Scene scene = all_lights();
  scene.integrator.caustics.photons = 1000, scene.integrator.caustics.passes = 1;
  const Picture want = run(scene, [](RenderOptions& o) { o.threads = 1; }).picture;
  EXPECT_TRUE(same_bytes(run(scene, [](RenderOptions& o) { o.threads = 3, o.tile_size = 5; }).picture, want));
  EXPECT_TRUE(same_bytes(run(scene, [](RenderOptions& o) { o.isa = Isa::scalar; }).picture, want));
}

TEST(LightGroups, AreNumberedByTheirFirstNameAndLimited) {
  Scene scene = all_lights();
  const LightGroups groups = light_groups(scene);
  EXPECT_EQ(groups.names, (std::vector<std::string>{"default", "red", "green", "blue"}));
  EXPECT_EQ(groups.material(0), 0);
  EXPECT_EQ(groups.material(kNoId), 0);
  for (std::size_t i = groups.names.size(); i < kMostLightGroups; ++i)
    add_lamp_material(scene, {1, 1, 1}, "g" + std::to_string(i));
  EXPECT_EQ(light_groups(scene).names.size(), kMostLightGroups);
  add_lamp_material(scene, {1, 1, 1}, "g7");
  EXPECT_NO_THROW(light_groups(scene));
  add_lamp_material(scene, {1, 1, 1}, "one more");
  EXPECT_THROW(light_groups(scene), Error);
}

}  // namespace
}  // namespace oktett::light_groups_test
