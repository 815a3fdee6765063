#include "render/camera.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

#include "render/picture/prepared_scene.h"

namespace oktett::camera_test {
namespace {

Film film(std::uint32_t width, std::uint32_t height) {
  Film f;
  f.width = width, f.height = height;
  return f;
}

/// Where `p` appears, in pixels from the upper left corner.
void project(const Camera& camera, const Film& f, const Vec3d& p, double& x, double& y) {
  const CameraFrame frame = camera_frame(camera, f);
  const Vec3d d = p - frame.origin;
  const double scale = camera.projection == Projection::perspective ? dot(d, frame.forward) : 1;
  x = f.width / 2.0 + dot(d, frame.right) / scale / frame.pixel_size;
  y = f.height / 2.0 - dot(d, frame.up) / scale / frame.pixel_size;
}

TEST(Camera, LooksWhereItSays) {
  Camera camera;
  camera.from = {1, 2, 3}, camera.at = {1, 2, -7}, camera.fov = 60;
  const CameraFrame frame = camera_frame(camera, film(200, 100));
  const Ray centre = camera_ray(frame, 100, 50);
  EXPECT_EQ(centre.origin, (Vec3f{1, 2, 3}));
  EXPECT_NEAR(length(centre.direction - Vec3f{0, 0, -1}), 0, 1e-7f);
  // The field of view is the full vertical angle; x grows to the right and y downwards.
  const double half = std::tan(30 * std::numbers::pi / 180);
  EXPECT_NEAR(length(camera_ray(frame, 100, 0).direction - Vec3f(normalize(Vec3d{0, half, -1}))), 0, 1e-6f);
  EXPECT_NEAR(length(camera_ray(frame, 200, 50).direction - Vec3f(normalize(Vec3d{2 * half, 0, -1}))), 0,
              1e-6f);
  EXPECT_NEAR(camera_depth(frame, {5, 5, -1}), 4, 1e-12);
}

TEST(Camera, OrthographicRaysAreParallel) {
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.height = 4;
  const CameraFrame frame = camera_frame(camera, film(40, 20));
  const Ray corner = camera_ray(frame, 0, 0), centre = camera_ray(frame, 20, 10);
  EXPECT_EQ(corner.direction, centre.direction);
  EXPECT_NEAR(length(corner.origin - Vec3f{-4, 2, 5}), 0, 1e-6f);
}

TEST(Camera, AFrameFillsThePictureWhateverItsForm) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    Camera camera;
    camera.projection = projection, camera.from = {1, 2, 3};
    // Sheared and left-handed.
    const ViewFrame view{{2, 0, 0.5}, {0.25, 1.5, 0}, {0.5, 0.25, 3}};
    camera.set_frame(view);
    for (const Film& f : {film(200, 100), film(30, 90)}) {
      const CameraFrame frame = camera_frame(camera, f);
      for (const double x : {0.0, 0.5, 1.0})
        for (const double y : {0.0, 0.5, 1.0}) {
          const Ray ray = camera_ray(frame, x * f.width, y * f.height);
          const Vec3d across = view.right * (x - 0.5) + view.up * (0.5 - y);
          const bool perspective = projection == Projection::perspective;
          const Vec3d origin = camera.from + (perspective ? Vec3d{} : across);
          const Vec3d direction = perspective ? view.direction + across : view.direction;
          EXPECT_LT(length(Vec3d(ray.origin) - origin), 1e-6);
          EXPECT_LT(length(Vec3d(ray.direction) - normalize(direction)), 1e-6);
        }
      EXPECT_NEAR(dot(frame.right, frame.up), 0, 1e-12);
      EXPECT_NEAR(dot(frame.right, frame.forward), 0, 1e-12);
    }
  }
}

TEST(Camera, AFrameThatSaysTheSameGivesTheSameRays) {
  Camera plain;
  plain.from = {1, 2, 3}, plain.at = {0, 0, -1}, plain.fov = 50;
  const Film f = film(80, 40);
  const CameraFrame expected = camera_frame(plain, f);
  const double height = 2 * std::tan(25 * std::numbers::pi / 180);
  Camera framed = plain;
  framed.set_frame({expected.right * (2 * height), expected.up * height, expected.forward});
  EXPECT_NEAR(framed.fov, 50, 1e-9);
  const CameraFrame found = camera_frame(framed, f);
  for (int i = 0; i < 20; ++i) {
    const double x = 4.1 * i, y = 39 - 1.9 * i;
    EXPECT_LT(length(camera_ray(expected, x, y).direction - camera_ray(found, x, y).direction), 1e-6f);
  }
  EXPECT_NEAR(found.pixel_size, expected.pixel_size, 1e-12);
  EXPECT_NEAR(camera_depth(found, {5, 5, -1}), camera_depth(expected, {5, 5, -1}), 1e-9);
}

TEST(Camera, AFrameFollowsTheView) {
  Camera before;
  before.from = {0, 0, -5};
  before.set_frame({{2, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  Camera after = before;
  after.from = {5, 0, 0}, after.at = {0, 0, 0};
  carry_frame(before, after);
  // Still left-handed.
  EXPECT_LT(length(after.frame->direction - Vec3d{-1, 0, 0}), 1e-9);
  EXPECT_LT(length(after.frame->right - Vec3d{0, 0, 2}), 1e-9);
  EXPECT_LT(length(after.frame->up - Vec3d{0, 1, 0}), 1e-9);
}

TEST(Camera, OddViewsStillGiveRays) {
  for (const Vec3d& up : {Vec3d{0, 0, 1}, Vec3d{0, 0, 0}, Vec3d{0, 0, -3}})
    for (const Vec3d& from : {Vec3d{0, 0, 5}, Vec3d{0, 0, 0}}) {
      Camera camera;
      camera.from = from, camera.up = up;
      const Ray ray = camera_ray(camera_frame(camera, film(8, 8)), 1, 2);
      EXPECT_TRUE(is_finite(ray.direction));
      EXPECT_NEAR(length(ray.direction), 1, 1e-6f);
    }
}

TEST(Crop, FractionsThatMeetTileTheFrame) {
  for (const std::uint32_t size : {1u, 7u, 100u, 959u, 960u, 1001u})
    for (double at = 0; at <= 1; at += 0.01) {
      Film left = film(size, 4), right = film(size, 4);
      left.crop[1] = right.crop[0] = at;
      const PixelWindow a = crop_window(left), b = crop_window(right);
      EXPECT_EQ(a.x0, 0u);
      EXPECT_EQ(b.x1, size);
      if (at * size > 1 && at * size < size - 1) {
        EXPECT_EQ(a.x1, b.x0) << size << ' ' << at;
      }
      EXPECT_GT(a.x1, a.x0);
      EXPECT_GT(b.x1, b.x0);
    }
  Film f = film(100, 100);
  f.crop[0] = 0.55, f.crop[1] = 0.7;
  EXPECT_EQ(crop_window(f).x0, 55u);
  EXPECT_EQ(crop_window(f).x1, 70u);
}

// The camera footprint is the difference of the hit points of neighbouring pixels' rays.
TEST(Camera, FootprintReachesTheNeighboursHitPoints) {
  for (const bool framed : {false, true})
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
      Camera camera;
      camera.projection = projection;
      camera.from = {1, 3, 4};
      if (framed) camera.set_frame({{-1, 0, 0.2}, {0, 0.9, 0}, {-0.3, -1, -1.2}});
      const CameraFrame frame = camera_frame(camera, film(64, 48));
      const Vec3f n{0, 1, 0};
      const auto ground = [&](double x, double y) {
        const Ray r = camera_ray(frame, x, y);
        return r.origin + r.direction * (-r.origin.y / r.direction.y);
      };
      Vec3f dx, dy;
      pixel_footprint(frame, camera_ray(frame, 20, 30), ground(20, 30), n, dx, dy);
      EXPECT_LT(length(dx - (ground(21, 30) - ground(20, 30))), 1e-4f);
      EXPECT_LT(length(dy - (ground(20, 31) - ground(20, 30))), 1e-4f);
    }
}

RC_GTEST_PROP(DefaultView, CutsNothingOff, ()) {
  const auto number = [] { return static_cast<float>(*rc::gen::inRange(-1000, 1000)) / 7; };
  Box box;
  box.grow(Vec3f{number(), number(), number()});
  box.grow(Vec3f{number(), number(), number()});
  Camera given;
  if (*rc::gen::arbitrary<bool>()) given.projection = Projection::orthographic;
  const Film f = film(*rc::gen::inRange(1u, 300u), *rc::gen::inRange(1u, 300u));
  const Camera camera = frame_bounds(box, given, f);
  bool fills = false;
  for (int corner = 0; corner < 8; ++corner) {
    double x, y;
    project(camera, f,
            {corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
             corner & 4 ? box.hi.z : box.lo.z},
            x, y);
    RC_ASSERT(x >= 0 && x <= f.width && y >= 0 && y <= f.height);
    fills |= x < f.width * 0.03 || x > f.width * 0.97 || y < f.height * 0.03 || y > f.height * 0.97;
  }
  RC_ASSERT(fills || box.extent() == Vec3f{});
}

TEST(DefaultView, AnythingGivesACamera) {
  const float inf = std::numeric_limits<float>::infinity();
  for (const Box& box : {Box{}, Box{{1, 2, 3}, {1, 2, 3}}, Box{{-inf, 0, 0}, {inf, 1, 1}},
                         Box{{0, 0, 0}, {1e30f, 1, 1}}, Box{{-1e-30f, 0, 0}, {1e-30f, 0, 0}}}) {
    const Camera camera = frame_bounds(box, {}, film(16, 9));
    EXPECT_TRUE(is_finite(camera.from));
    EXPECT_FALSE(camera.from == camera.at);
  }
}

// The camera looks down at the same angle, from the right of the front, whichever axis points up.
TEST(DefaultView, AnyAxisMayPointUp) {
  const double usual = normalize(Vec3d{0.55, 0.45, 1}).y;
  for (const Vec3d& up : {Vec3d{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
    Camera given;
    given.up = up;
    const Camera camera = frame_bounds({{-1, -1, -1}, {1, 1, 1}}, given, film(16, 9));
    EXPECT_NEAR(dot(normalize(camera.from - camera.at), up), usual, 1e-6)
        << up.x << ' ' << up.y << ' ' << up.z;
  }
}

TEST(DefaultView, LightsComeFromTheCamerasSide) {
  Camera camera;
  camera.from = {3, 1, -2};
  const CameraFrame frame = camera_frame(camera, film(16, 9));
  const std::vector<Light> lights = default_lights(camera, film(16, 9));
  ASSERT_EQ(lights.size(), 2u);
  for (const Light& light : lights) {
    const Vec3d d = std::get<DirectionalLight>(light).direction;
    EXPECT_GT(dot(d, frame.forward), 0);
    EXPECT_LT(dot(d, frame.up), 0);
  }
}

}  // namespace
}  // namespace oktett::camera_test
