/// \file Cryptomatte: hashes against published values, coverage against geometry.

#include "render/film/cryptomatte.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>

#include "tests/render/test_scenes.h"

namespace oktett::cryptomatte_test {
namespace {

using namespace test;

TEST(Cryptomatte, HashesAreThoseOfMurmur3) {
  EXPECT_EQ(murmur_hash(""), 0u);
  EXPECT_EQ(murmur_hash("test"), 0xba6bd213u);
  EXPECT_EQ(murmur_hash("Hello, world!"), 0xc0363e43u);
  EXPECT_EQ(murmur_hash("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
}

// Every id is a normal number, so that no program changes it.
TEST(Cryptomatte, IdsAreNormalNumbers) {
  int changed = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string name = "object" + std::to_string(i);
    const float id = matte_id(name);
    ASSERT_TRUE(std::isnormal(id)) << name;
    changed += std::bit_cast<std::uint32_t>(id) != murmur_hash(name) ? 1 : 0;
  }
  EXPECT_GT(changed, 0);
  EXPECT_LT(changed, 60);
}

/// The part of a pixel that a name covers.
float coverage(const Picture& p, const std::string& layer, const std::string& name, std::uint32_t x,
               std::uint32_t y) {
  float sum = 0;
  for (int k = 0; k < kMatteLevels; ++k) {
    const std::string plane = layer + "0" + std::to_string(k / 2) + ".";
    if (value(p, (plane + "RB"[k % 2]).c_str(), x, y) == matte_id(name))
      sum += value(p, (plane + "GA"[k % 2]).c_str(), x, y);
  }
  return sum;
}

Scene two_boxes() {
  Scene scene = bare_scene(4);
  scene.integrator.samples = 256;
  scene.camera.projection = Projection::orthographic;
  scene.camera.height = 4;
  scene.film.cryptomatte = true;
  Material red = diffuse({1, 0, 0});
  red.name = "red";
  add_object(scene, BoxShape{{-0.75, -9, -1}, {0.5, 9, 1}}, add_material(scene, red));
  scene.objects.back().name = "left";
  add_object(scene, BoxShape{{0.5, -9, -1}, {9, 9, 1}}, 0);
  add_object(scene, BoxShape{{-9, -9, -3}, {-1.5, 9, -2}}, kNoId);
  return scene;
}

TEST(Cryptomatte, CoverageIsThatOfThePixel) {
  for (const bool adaptive : {false, true}) {
    Scene scene = two_boxes();
    if (adaptive) scene.integrator.error = 0.01, scene.integrator.max_samples = 1024;
    const Picture p = run(scene).picture;
    EXPECT_NEAR(coverage(p, "CryptoObject", "left", 1, 1), 0.75f, 1e-3f);
    EXPECT_EQ(coverage(p, "CryptoObject", "object1", 1, 1), 0);
    EXPECT_NEAR(coverage(p, "CryptoObject", "left", 2, 1), 0.5f, 1e-3f);
    EXPECT_NEAR(coverage(p, "CryptoObject", "object1", 2, 1), 0.5f, 1e-3f);
    EXPECT_NEAR(coverage(p, "CryptoMaterial", "red", 2, 1), 1, 1e-6f);
    EXPECT_NEAR(coverage(p, "CryptoMaterial", "default", 0, 2), 0.5f, 1e-3f);
    // The greatest part stands first.
    EXPECT_EQ(value(p, "CryptoObject00.R", 1, 1), matte_id("left"));
  }
}

// Of the samples that meet a surface of opacity 1/4, path tracing sends 3/4 on to what lies behind it.
TEST(Cryptomatte, HolesShowWhatLiesBehind) {
  Scene scene = bare_scene(4);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = 1024;
  scene.film.cryptomatte = true;
  Material veil = diffuse({1, 0, 0});
  veil.name = "veil", veil.opacity = 0.25f;
  add_object(scene, BoxShape{{-9, -9, -0.1}, {9, 9, 0}}, add_material(scene, veil));
  scene.objects.back().name = "front";
  add_object(scene, PlaneShape{{0, 0, 1}, -1}, add_material(scene, diffuse({1, 1, 1})));
  scene.objects.back().name = "wall";
  const Picture p = run(scene).picture;
  // The box has two sides.
  const float passed = 0.75f * 0.75f;
  EXPECT_NEAR(coverage(p, "CryptoObject", "front", 1, 1), 1 - passed, 0.02f);
  EXPECT_NEAR(coverage(p, "CryptoMaterial", "veil", 1, 1), 1 - passed, 0.02f);
  EXPECT_NEAR(coverage(p, "CryptoObject", "wall", 1, 1), passed, 0.02f);
}

TEST(Cryptomatte, IsWrittenOnlyOnDemand) {
  Scene scene = two_boxes();
  EXPECT_EQ(run(scene).picture.attributes.size(), 8u);
  EXPECT_EQ(run(scene, [](RenderOptions& o) { o.data_layers = false; }).picture.planes.size(), 4u);
  const Picture with = run(scene).picture;
  scene.film.cryptomatte = false;
  const Picture without = run(scene).picture;
  EXPECT_EQ(without.find("CryptoObject00.R"), nullptr);
  EXPECT_TRUE(without.attributes.empty());
  // The other planes keep their bits.
  for (const PicturePlane& plane : without.planes)
    if (plane.values.size() > 0) {
      EXPECT_TRUE(std::equal(plane.values.begin(), plane.values.end(), with.find(plane.name)->values.begin()))
          << plane.name;
    }
}

// More names than there are levels: the greatest parts are kept. Names may hold anything.
TEST(Cryptomatte, ManyAndOddNames) {
  Scene scene = two_boxes();
  scene.objects.clear();
  for (int i = 0; i < 40; ++i) {
    add_object(scene, BoxShape{{-2 + 0.1 * i, -9, -1}, {-1.9 + 0.1 * i, 9, 1}}, 0);
    scene.objects.back().name = i == 0 ? "a \"quoted\"\n\\name" : i == 1 ? "\xc3\xa4" : "same";
  }
  const Picture p = run(scene).picture;
  EXPECT_NEAR(coverage(p, "CryptoObject", "a \"quoted\"\n\\name", 0, 0), 0.1f, 0.01f);
  EXPECT_NEAR(coverage(p, "CryptoObject", "same", 0, 0), 0.8f, 0.01f);
  EXPECT_NEAR(coverage(p, "CryptoObject", "same", 2, 0), 1, 1e-6f);
  bool found = false;
  for (const auto& [name, text] : p.attributes)
    found |= text.find("\"a \\\"quoted\\\"\\u000a\\\\name\":\"") != std::string::npos;
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace oktett::cryptomatte_test
