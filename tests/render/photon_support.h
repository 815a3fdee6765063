#pragma once
/// \file Photons of small scenes, without a picture.

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

}  // namespace oktett::test
