#pragma once
/// \file Photons of small scenes, and pictures with caustics against pictures without.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "render/photon/caustics.h"
#include "render/photon/trace_photons.h"
#include "tests/render/test_scenes.h"

namespace oktett::test {

/// A scene made ready to send photons. Not movable: its members point to each other.
struct PhotonScene {
  explicit PhotonScene(Scene given)
      : scene(with_path(std::move(given))),
        world(build_world(scene)),
        lights(scene, world),
        context(make_context(scene, world, lights, nullptr, default_isa())),
        source(world, lights, nullptr, find_casters(world)) {
    context.camera = {}, context.data_layers = false;
  }
  PhotonScene(const PhotonScene&) = delete;
  PhotonScene& operator=(const PhotonScene&) = delete;

  static Scene with_path(Scene s) {
    s.integrator.kind = IntegratorKind::path;
    return s;
  }

  Scene scene;
  World world;
  SceneLights lights;
  RenderContext context;
  PhotonSource source;
};

/// Many photons in one pass.
inline PhotonPlan plan_of(std::uint32_t photons, std::uint32_t depth = 8) {
  PhotonPlan plan;
  plan.photons = photons, plan.passes = 1, plan.depth = depth;
  return plan;
}

/// A ball of glass and a mirror on a floor, under a lamp that paths can find.
inline Scene lamp_over_glass(const Material& ball) {
  Scene scene = bare_scene(12);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.depth = 5;
  scene.camera.from = {0, 3, 4}, scene.camera.at = {0, 0.3, 0}, scene.camera.fov = 40;
  add_object(scene, PlaneShape{{0, 1, 0}, 0}, add_material(scene, diffuse({0.6f, 0.6f, 0.6f})));
  add_object(scene, SphereShape{{-0.5, 0.7, 0}, 0.5}, add_material(scene, ball));
  // Scatters light itself, too.
  Material shiny = diffuse({0.5f, 0.3f, 0.3f});
  shiny.diffuse = 0.6f, shiny.reflection = 0.4f;
  add_object(scene, BoxShape{{0.4, 0, -0.4}, {0.9, 0.8, 0.4}}, add_material(scene, shiny));
  Material lamp = glowing({4, 4, 4});
  lamp.emits_behind = false;
  add_object(scene, DiskShape{{0, 4, 1}, {0, -1, 0}, 1.2}, add_material(scene, lamp));
  return scene;
}

/// Expects that blocks of the picture agree within what both pictures say of their own noise, but for a part
/// `bias` of the light.
inline void expect_same_light(const Scene& scene, const CausticSettings& caustics, double bias) {
  Scene plain = scene;
  plain.integrator.samples = 4096;
  Scene with = scene;
  with.integrator.samples = 512, with.integrator.caustics = caustics;
  const Picture a = run(plain).picture, b = run(with).picture;
  int apart = 0;
  for (std::uint32_t y = 0; y < 12; y += 3)
    for (std::uint32_t x = 0; x < 12; x += 3) {
      double difference = 0, variance = 0, light = 0;
      for (std::uint32_t k = 0; k < 9; ++k) {
        const std::uint32_t px = x + k % 3, py = y + k / 3;
        difference += double{value(a, "G", px, py)} - double{value(b, "G", px, py)};
        variance += double{value(a, "Variance.G", px, py)} + double{value(b, "Variance.G", px, py)};
        light += double{value(a, "G", px, py)};
      }
      const double allowed = 3 * std::sqrt(variance) + bias * light;
      if (std::abs(difference) > allowed) ++apart;
      EXPECT_LT(std::abs(difference), 2 * allowed) << x << ' ' << y << ' ' << light;
    }
  EXPECT_LE(apart, 1);
}

/// Settings for expect_same_light.
inline CausticSettings many_photons() {
  CausticSettings caustics;
  caustics.photons = 20000, caustics.passes = 64;
  return caustics;
}

}  // namespace oktett::test
