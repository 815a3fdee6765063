/// \file Photons of scenes with motion.

#include <gtest/gtest.h>

#include <string>

#include "core/error.h"
#include "tests/render/photon_support.h"

namespace oktett::photon_motion_test {
namespace {

using namespace test;

// Each moment has photons of its own: glass, lamp and the floor below move.
TEST(PhotonMotion, CausticsMoveWithWhatMakesThem) {
  const auto moving = [](const Vec3d& by) {
    auto motion = std::make_shared<Motion>();
    motion->factors = {{{0, Affine{}}, {1, Affine::translation(by)}}};
    return motion;
  };
  Scene scene = lamp_over_glass(glass(1.5f));
  scene.objects[0].shape = DiskShape{{0, 0, 0}, {0, 1, 0}, 9};
  scene.objects[0].motion = moving({0, 0.15, 0});
  scene.objects[1].motion = moving({1, 0.2, 0.3});
  scene.objects[3].motion = moving({0, 0, -0.5});
  scene.camera.shutter[0] = 0, scene.camera.shutter[1] = 1;
  expect_same_light(scene, many_photons(), 0.01);
  // Few passes mean few moments; then a glass that jumps is still seen with its own photons only.
  CausticSettings few = many_photons();
  few.passes = 5, few.photons = 2000;
  scene.integrator.caustics = few, scene.integrator.samples = 16;
  const Picture one = run(scene, [](RenderOptions& o) { o.threads = 1; }).picture;
  EXPECT_TRUE(same_bytes(one, run(scene, [](RenderOptions& o) { o.threads = 3; }).picture));
}

TEST(PhotonMotion, FilesBelongToTheMomentsOfTheirScene) {
  Scene scene = lamp_over_glass(glass(1.5f));
  scene.integrator.samples = 4, scene.integrator.depth = 3;
  scene.integrator.caustics.photons = 3000, scene.integrator.caustics.passes = 8;
  auto motion = std::make_shared<Motion>();
  motion->factors = {{{0, Affine{}}, {1, Affine::translation({1, 0, 0})}}};
  scene.objects[1].motion = motion;
  scene.camera.shutter[0] = 0, scene.camera.shutter[1] = 1;
  const RenderResult made = run(scene, [](RenderOptions& o) { o.keep_photons = true; });
  ASSERT_NE(made.photons, nullptr);
  EXPECT_EQ(made.photons->passes.size(), 8u);
  EXPECT_EQ(made.photons->plan.moments, 4u);
  EXPECT_TRUE(same_bytes(made.picture, run(scene).picture));
  const auto give = [&](RenderOptions& o) { o.photons = made.photons; };
  EXPECT_TRUE(same_bytes(made.picture, run(scene, give).picture));
  const auto expect_refused = [&](const Scene& changed, const char* what) {
    try {
      run(changed, give);
      ADD_FAILURE() << "accepted: " << what;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(what), std::string::npos) << e.what();
    }
  };
  Scene other = scene;
  other.integrator.samples = 8;
  expect_refused(other, "moments of motion: 4, the scene wants 8");
  other = scene, other.camera.shutter[1] = 0.5;
  expect_refused(other, "geometry");
  // Only the camera moves: one set of photons for all moments.
  other = scene, other.objects[1].motion = nullptr, other.camera.motion = motion;
  const RenderResult still = run(other, [](RenderOptions& o) { o.keep_photons = true; });
  EXPECT_EQ(still.photons->plan.moments, 1u);
  other.integrator.samples = 8, other.camera.motion = nullptr;
  EXPECT_TRUE(same_bytes(run(other).picture,
                         run(other, [&](RenderOptions& o) { o.photons = still.photons; }).picture));
}

}  // namespace
}  // namespace oktett::photon_motion_test
