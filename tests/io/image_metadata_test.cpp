#include "io/image/metadata.h"

#include <gtest/gtest.h>

#include <cmath>

namespace oktett::image_metadata_test {
namespace {

/// p' = [p 1] M, divided by w.
Vec3d project(const Matrix4& m, const Vec3d& p) {
  double v[4];
  for (int j = 0; j < 4; ++j) v[j] = p.x * m[j] + p.y * m[4 + j] + p.z * m[8 + j] + m[12 + j];
  return Vec3d{v[0], v[1], v[2]} / v[3];
}

// The corners of what the camera sees are the corners of the unit square, upper left first.
TEST(CameraMatrices, MapTheFrustumToTheUnitSquare) {
  Camera camera;
  camera.from = {1, 2, 8};
  camera.at = {1, 2, 3};
  camera.fov = 90;
  const auto m = camera_matrices(camera, 200, 100);
  ASSERT_TRUE(m);
  const Vec3d in_camera = project(m->world_to_camera, {2, 4, 5});
  EXPECT_NEAR(in_camera.x, 1, 1e-6);
  EXPECT_NEAR(in_camera.y, 2, 1e-6);
  EXPECT_NEAR(in_camera.z, 3, 1e-6);
  const Vec3d upper_left = project(m->world_to_ndc, {1 - 10, 2 + 5, 3});
  EXPECT_NEAR(upper_left.x, 0, 1e-6);
  EXPECT_NEAR(upper_left.y, 0, 1e-6);
  const Vec3d lower_right = project(m->world_to_ndc, {1 + 10, 2 - 5, 3});
  EXPECT_NEAR(lower_right.x, 1, 1e-6);
  EXPECT_NEAR(lower_right.y, 1, 1e-6);

  camera.projection = Projection::orthographic;
  camera.height = 4;
  const auto orthographic = camera_matrices(camera, 200, 100);
  ASSERT_TRUE(orthographic);
  const Vec3d corner = project(orthographic->world_to_ndc, {1 - 4, 2 + 2, -70});
  EXPECT_NEAR(corner.x, 0, 1e-6);
  EXPECT_NEAR(corner.y, 0, 1e-6);
}

TEST(CameraMatrices, MapTheFrameToTheUnitSquare) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    Camera camera;
    camera.projection = projection, camera.from = {1, 2, 8};
    const ViewFrame view{{-2, 0, 0.5}, {0.25, 1.5, 0}, {0.5, 0.25, -2}};
    camera.set_frame(view);
    const auto m = camera_matrices(camera, 200, 100);
    ASSERT_TRUE(m);
    const bool perspective = projection == Projection::perspective;
    for (const double x : {0.0, 0.3, 1.0})
      for (const double y : {0.0, 0.6, 1.0}) {
        const Vec3d across = view.right * (x - 0.5) + view.up * (0.5 - y);
        const Vec3d p =
            camera.from + (perspective ? (view.direction + across) * 3.0 : across + view.direction);
        const Vec3d found = project(m->world_to_ndc, p);
        EXPECT_NEAR(found.x, x, 1e-5);
        EXPECT_NEAR(found.y, y, 1e-5);
      }
    // The first axis of the camera is that of the picture.
    EXPECT_GT(project(m->world_to_camera, camera.from + view.direction + view.right * 0.1).x,
              project(m->world_to_camera, camera.from + view.direction).x);
  }
}

TEST(CameraMatrices, DegenerateCamerasGiveNoneOrAnyRoll) {
  Camera camera;
  camera.at = camera.from;
  EXPECT_FALSE(camera_matrices(camera, 2, 2));
  camera = Camera{};
  camera.up = {0, 0, 1};
  EXPECT_TRUE(camera_matrices(camera, 2, 2));
  EXPECT_FALSE(camera_matrices(camera, 0, 2));
}

}  // namespace
}  // namespace oktett::image_metadata_test
