// Curved projections: where they look, against POV-Ray's pictures, other pictures and the inverse
// projections.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "render/camera.h"
#include "tests/render/test_scenes.h"

namespace oktett::curved_view_test {
namespace {

using namespace test;

constexpr Projection kCurved[] = {Projection::fisheye,   Projection::ultra_wide_angle, Projection::omnimax,
                                  Projection::panoramic, Projection::cylindrical,      Projection::spherical};

Film film(std::uint32_t width, std::uint32_t height) {
  Film f;
  f.width = width, f.height = height;
  return f;
}

/// A camera and what POV-Ray 3.7.0.10 shows at four pixels of 33 x 25: places on a ball around the eye that
/// is coloured by place, in 16 bits. Zero: no ray.
struct Shown {
  struct {
    Projection projection;
    ViewFrame frame;
    double angle[2];
    CylinderAxis axis;
  } camera;
  Vec3d places[4];
};

const std::vector<Shown>& shown_by_povray() {
  static const std::vector<Shown> all{
      // fisheye angle 120 right 4/3*x
      {{Projection::fisheye, {{4.0 / 3, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {120, 0}, CylinderAxis::up},
       {{0.5996, 0.4452, 0.6651}, {0, 0, 0}, {0.0000, 0.6846, 0.7290}, {-0.6496, -0.5002, 0.5725}}},
      // fisheye angle 300 right 1.5*x up 0.8*y direction 2*z
      {{Projection::fisheye, {{1.5, 0, 0}, {0, 0.8, 0}, {0, 0, 2}}, {300, 0}, CylinderAxis::up},
       {{0.7386, 0.3900, -0.5500}, {0, 0, 0}, {0.0000, 0.9980, 0.0628}, {-0.5647, -0.3092, -0.7652}}},
      // fisheye angle 120 right x matrix <1,0,0,0.5,1,0,0,0,1,0,0,0>
      {{Projection::fisheye, {{1, 0, 0}, {0.5, 1, 0}, {0, 0, 1}}, {120, 0}, CylinderAxis::up},
       {{0.6260, 0.4145, 0.6606},
        {0.7346, 0.0000, 0.6785},
        {0.3339, 0.6678, 0.6653},
        {-0.6770, -0.4593, 0.5751}}},
      // ultra_wide_angle angle 220 right 1.5*x
      {{Projection::ultra_wide_angle, {{1.5, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {220, 0}, CylinderAxis::up},
       {{0.7281, 0.5232, 0.4429},
        {0.9983, 0.0000, 0.0581},
        {0.0000, 0.7966, 0.6046},
        {-0.7527, -0.5710, 0.3277}}},
      // ultra_wide_angle angle 120 right x matrix <1,0,0,0.5,1,0,0.2,0,1,0,0,0>
      {{Projection::ultra_wide_angle, {{1, 0, 0}, {0.5, 1, 0}, {0.2, 0, 1}}, {120, 0}, CylinderAxis::up},
       {{0.7079, 0.3880, 0.5902},
        {0.7936, 0.0000, 0.6085},
        {0.4453, 0.6405, 0.6257},
        {-0.6255, -0.4997, 0.5992}}},
      // omnimax right 4/3*x
      {{Projection::omnimax, {{4.0 / 3, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0}, CylinderAxis::up},
       {{0.5842, 0.6899, 0.4274},
        {0.9166, 0.2473, 0.3141},
        {0.0000, 0.9058, 0.4237},
        {-0.7057, -0.2683, 0.6558}}},
      // omnimax right 1.1*x
      {{Projection::omnimax, {{1.1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0}, CylinderAxis::up},
       {{0.5784, 0.6290, 0.5194},
        {0.9079, 0.1048, 0.4060},
        {0.0000, 0.8782, 0.4783},
        {-0.6585, -0.5049, 0.5581}}},
      // omnimax right 2*x up 3*y
      {{Projection::omnimax, {{2, 0, 0}, {0, 3, 0}, {0, 0, 1}}, {0, 0}, CylinderAxis::up},
       {{0.5367, 0.7969, 0.2773}, {0.9101, 0.0000, 0.4142}, {0, 0, 0}, {0, 0, 0}}},
      // panoramic right 4/3*x
      {{Projection::panoramic, {{4.0 / 3, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0}, CylinderAxis::up},
       {{0.6131, 0.6257, 0.4823},
        {0.9679, 0.0000, 0.2513},
        {0.0000, 0.9048, 0.4258},
        {-0.5912, -0.7091, 0.3842}}},
      // panoramic right 1.5*x matrix <1,0,0,0.5,1,0,0.3,0,1,0,0,0>
      {{Projection::panoramic, {{1.5, 0, 0}, {0.5, 1, 0}, {0.3, 0, 1}}, {0, 0}, CylinderAxis::up},
       {{0.8237, 0.4492, 0.3462},
        {0.9775, 0.0000, 0.2110},
        {0.5018, 0.7826, 0.3683},
        {-0.7463, -0.5852, 0.3171}}},
      // cylinder 1 angle 240 right 2*x up 3*y direction 2*z
      {{Projection::cylindrical, {{2, 0, 0}, {0, 3, 0}, {0, 0, 2}}, {240, 0}, CylinderAxis::up},
       {{0.6896, 0.5843, 0.4278},
        {0.9969, 0.0000, -0.0793},
        {0.0000, 0.7337, 0.6794},
        {-0.6965, -0.6432, 0.3181}}},
      // cylinder 2 angle 120 right 2*x up 3*y
      {{Projection::cylindrical, {{2, 0, 0}, {0, 3, 0}, {0, 0, 1}}, {120, 0}, CylinderAxis::right},
       {{0.4363, 0.4335, 0.7885},
        {0.6189, 0.0000, 0.7855},
        {0.0000, 0.6846, 0.7290},
        {-0.4789, -0.4858, 0.7312}}},
      // cylinder 1 angle 120 right x up 2*y matrix <1,0,0,0.5,1,0,0.3,0,1,0,0,0>
      {{Projection::cylindrical, {{1, 0, 0}, {1, 2, 0}, {0.3, 0, 1}}, {120, 0}, CylinderAxis::up},
       {{0.7116, 0.3495, 0.6095},
        {0.8196, 0.0000, 0.5730},
        {0.4753, 0.5287, 0.7033},
        {-0.5082, -0.4916, 0.7073}}},
      // spherical right x
      {{Projection::spherical, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {360, 180}, CylinderAxis::up},
       {{0.7281, 0.6846, 0.0347},
        {0.6181, 0.0000, -0.7861},
        {0.0000, 0.9048, 0.4258},
        {-0.6310, -0.7705, -0.0907}}},
      // spherical angle 200 100 right 4/3*x
      {{Projection::spherical, {{4.0 / 3, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {200, 100}, CylinderAxis::up},
       {{0.6841, 0.4067, 0.6055},
        {0.9809, 0.0000, 0.1944},
        {0.0000, 0.5878, 0.8090},
        {-0.7192, -0.4695, 0.5122}}},
      // spherical angle 120 right x matrix <1,0,0,0.5,1,0,0,0,1,0,0,0>
      {{Projection::spherical, {{1, 0, 0}, {0.5, 1, 0}, {0, 0, 1}}, {120, 60}, CylinderAxis::up},
       {{0.4338, 0.0318, 0.9005},
        {0.6570, -0.3285, 0.6785},
        {0.0000, 0.3681, 0.9298},
        {-0.4813, -0.0484, 0.8752}}},
  };
  return all;
}

TEST(CurvedView, LooksWherePovRayDoes) {
  constexpr int kPixels[4][2] = {{24, 6}, {29, 12}, {16, 3}, {7, 19}};
  for (const Shown& shown : shown_by_povray()) {
    Camera camera;
    camera.projection = shown.camera.projection, camera.axis = shown.camera.axis;
    camera.angle[0] = shown.camera.angle[0], camera.angle[1] = shown.camera.angle[1];
    camera.set_frame(shown.camera.frame);
    const CameraFrame frame = camera_frame(camera, film(33, 25));
    for (int i = 0; i < 4; ++i) {
      SCOPED_TRACE(&shown - shown_by_povray().data());
      const Ray ray = camera_ray(frame, kPixels[i][0] + 0.5, kPixels[i][1] + 0.5);
      EXPECT_EQ(leaves_out(ray), length(shown.places[i]) == 0);
      if (leaves_out(ray)) continue;
      EXPECT_LT(length(Vec3d(ray.direction) - shown.places[i]), 6e-4) << i;
      EXPECT_EQ(ray.origin, (Vec3f{0, 0, 5}));
    }
  }
}

// As measured of cylinders 3 and 4: a ray passes (0, 7.202, 0), or (4.849, 0, 0).
TEST(CurvedView, TheEyeMovesAlongTheAxisOfACylinder) {
  Camera camera;
  camera.projection = Projection::cylindrical, camera.along_axis = Projection::orthographic;
  camera.angle[0] = 120, camera.from = {0, 0, 0};
  camera.set_frame({{20, 0, 0}, {0, 30, 0}, {0, 0, 10}});
  const Ray up = camera_ray(camera_frame(camera, film(33, 25)), 24.5, 6.5);
  EXPECT_LT(length(Vec3d(up.origin) - Vec3d{0, 7.2, 0}), 1e-5);
  EXPECT_LT(length(Vec3d(up.direction) - Vec3d{0.4862, 0, 0.8739}), 2e-4);
  camera.axis = CylinderAxis::right;
  const CameraFrame frame = camera_frame(camera, film(33, 25));
  const Ray right = camera_ray(frame, 24.5, 6.5);
  EXPECT_LT(length(Vec3d(right.origin) - Vec3d{4.8485, 0, 0}), 1e-4);
  EXPECT_LT(length(Vec3d(right.direction) - Vec3d{0, 0.4817, 0.8763}), 2e-4);
  // Its depth counts from the axis.
  EXPECT_NEAR(camera_depth(frame, {100, 3, 4}), 5, 1e-9);
}

/// The direction in the camera's own axes: to the right, up and ahead.
Vec3d own(const CameraFrame& frame, const Ray& ray) {
  const Vec3d d(ray.direction);
  return {dot(d, frame.right), dot(d, frame.up), dot(d, frame.forward)};
}

/// Without a frame, right-handed, of square pixels in the middle. The inverse of each projection finds the
/// place on the film again.
TEST(CurvedView, InversesLeadBack) {
  constexpr double kPi = std::numbers::pi;
  const Film f = film(160, 90);
  const double aspect = 160.0 / 90;
  for (const Projection projection : kCurved)
    for (const CylinderAxis axis : {CylinderAxis::up, CylinderAxis::right}) {
      Camera camera;
      camera.projection = projection, camera.axis = axis;
      camera.from = {3, 2, 1}, camera.at = {-1, 0, 4}, camera.up = {0.2, 1, 0};
      if (has_angle(projection)) camera.angle[0] = 150;
      const double angle = 150 * kPi / 180;
      const CameraFrame frame = camera_frame(camera, f);
      int seen = 0;
      for (double x = 3.25; x < 160; x += 17)
        for (double y = 2.75; y < 90; y += 11) {
          const Ray ray = camera_ray(frame, x, y);
          if (leaves_out(ray)) continue;
          ++seen;
          const Vec3d d = own(frame, ray);
          const double from_axis = std::acos(d.z), across = std::hypot(d.x, d.y);
          // In halves of the height, or in parts of the width and the height.
          Vec3d found{(x - 80) / 45, (45 - y) / 45, 0}, want{0, 0, 0};
          const double u = (x - 80) / 160, v = (45 - y) / 90;
          switch (projection) {
            case Projection::fisheye:
              want = Vec3d{d.x, d.y, 0} * (from_axis / (angle / 2) / across);
              break;
            case Projection::ultra_wide_angle: {
              // From tan a = X cos b and tan b = Y cos a.
              double a = 0, b = 0;
              for (int k = 0; k < 200; ++k) {
                a = std::atan(d.x / d.z * std::cos(b));
                b = std::atan(d.y / d.z * std::cos(a));
              }
              want = {a, b, 0}, found = {u * angle, v * angle / aspect, 0};
              break;
            }
            case Projection::omnimax:
              // Only that equal distances from the middle of the dome are equal angles.
              found = found * 0.77915 + Vec3d{0, 1 - 0.77915, 0};
              want = Vec3d{d.x, d.y, 0} * (length(found) / across);
              break;
            case Projection::panoramic:
              found = {u, v, 0};
              want = {std::atan2(d.x / aspect, d.z) / kPi,
                      std::atan(d.y / std::hypot(d.x / aspect, d.z)) / kPi, 0};
              break;
            case Projection::cylindrical:
              found = {u, v, 0};
              want =
                  axis == CylinderAxis::up
                      ? Vec3d{std::atan2(d.x, d.z) / angle, d.y / std::hypot(d.x, d.z) * aspect / angle, 0}
                      : Vec3d{d.x / std::hypot(d.y, d.z) / aspect / angle, std::atan2(d.y, d.z) / angle, 0};
              break;
            default:
              found = {u * angle, v * angle / 2, 0};
              want = {std::atan2(d.x, d.z), std::asin(d.y), 0};
          }
          EXPECT_LT(length(found - want), 1e-5)
              << kProjections[static_cast<int>(projection)].name << " at " << x << ", " << y;
        }
      EXPECT_GT(seen, 20);
    }
}

// Its lower edge, in pixels of 200 x 150 of POV-Ray's picture: the last that is seen in a column.
TEST(CurvedView, TheDomeHasAnEdgeBelow) {
  Camera camera;
  camera.projection = Projection::omnimax;
  camera.set_frame({{2, 0, 0}, {0, 2, 0}, {0, 0, 1}});
  const CameraFrame frame = camera_frame(camera, film(200, 150));
  constexpr int kLast[][2] = {{100, 116}, {118, 115}, {136, 112}, {154, 107},
                              {172, 100}, {190, 86},  {199, 75}};
  for (const auto& [x, y] : kLast) {
    EXPECT_FALSE(leaves_out(camera_ray(frame, x + 0.5, y + 0.5))) << x;
    EXPECT_TRUE(leaves_out(camera_ray(frame, x + 0.5, y + 1.5))) << x;
  }
}

TEST(CurvedView, TheFisheyeHasACircle) {
  Camera camera;
  camera.projection = Projection::fisheye;
  const CameraFrame frame = camera_frame(camera, film(200, 100));
  EXPECT_FALSE(leaves_out(camera_ray(frame, 100, 0.5)));
  EXPECT_FALSE(leaves_out(camera_ray(frame, 149.5, 50)));
  EXPECT_TRUE(leaves_out(camera_ray(frame, 150.5, 50)));
  // The usual angle is 180 degrees.
  EXPECT_NEAR(dot(camera_ray(frame, 149.99, 50).direction, Vec3f{1, 0, 0}), 1, 1e-5f);
}

// A picture of all directions shows the environment pixel by pixel.
TEST(CurvedView, SphericalIsTheMapOfEnvironments) {
  Camera camera;
  camera.projection = Projection::spherical, camera.from = {0, 0, 0}, camera.at = {0, 0, -1};
  const CameraFrame frame = camera_frame(camera, film(80, 30));
  for (double x = 0.5; x < 80; x += 9)
    for (double y = 0.5; y < 30; y += 7)
      EXPECT_LT(length(camera_ray(frame, x, y).direction - environment_direction(x / 80, y / 30)), 1e-6f);
  Scene scene = bare_scene();
  scene.film.width = 8, scene.film.height = 4;
  scene.camera.projection = Projection::spherical;
  scene.camera.from = {0, 0, 0}, scene.camera.at = {0, 0, -1};
  EnvironmentPicture picture;
  picture.width = 8, picture.height = 4;
  for (int i = 0; i < 32; ++i) picture.pixels.push_back({i + 1.0f, 32.0f - i, 1});
  scene.lights = {EnvironmentLight{std::make_shared<const EnvironmentPicture>(picture), 0, {1, 1, 1}}};
  const Picture shown = run(scene).picture;
  for (std::uint32_t y = 0; y < 4; ++y)
    for (std::uint32_t x = 0; x < 8; ++x) {
      const Color want = picture.pixels[y * 8 + x];
      EXPECT_LT(length(color(shown, x, y) - want), 1e-3f) << x << ',' << y;
    }
}

// Nothing is seen outside of the circle, neither objects nor the background.
TEST(CurvedView, WhatIsLeftOutIsBlackAndNotCovered) {
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path, IntegratorKind::albedo})
    for (const bool fog : {false, true})
      for (const std::uint32_t samples : {1u, 9u}) {
        Scene scene = bare_scene(32);
        scene.film.width = 64;
        scene.integrator.kind = kind, scene.integrator.samples = samples;
        scene.background = {2, 3, 4};
        scene.camera.projection = Projection::fisheye;
        scene.camera.from = {0, 0, 0}, scene.camera.at = {0, 0, -1};
        add_object(scene, SphereShape{{0, 0, -5}, 1}, add_material(scene, diffuse({1, 1, 1})));
        if (fog) {
          Medium medium;
          medium.absorption = {0.01, 0.01, 0.01};
          scene.media.push_back(medium), scene.medium = 0;
        }
        const Picture shown = run(scene).picture;
        EXPECT_EQ(color(shown, 2, 16), (Color{0, 0, 0}));
        EXPECT_EQ(value(shown, "A", 2, 16), 0);
        // No light comes through fog without end.
        if (!fog || !traits(kind).bounces()) {
          EXPECT_GT(color(shown, 32, 1).x, 0);
        }
        EXPECT_GT(value(shown, "A", 32, 1), 0.9f);
        EXPECT_GT(value(shown, "A", 32, 16), 0.9f);
      }
}

TEST(CurvedView, RaysOfColumnsAreThoseOfPoints) {
  for (const Projection projection : kCurved) {
    Camera camera;
    camera.projection = projection;
    const CameraFrame frame = camera_frame(camera, film(40, 30));
    Column<double> x, y;
    for (int i = 0; i < 37; ++i) x.push_back(i * 1.07), y.push_back(29 - 0.77 * i);
    RayBatch rays;
    rays.resize_uninitialized(x.size());
    camera_rays(frame, {x, y}, rays);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Ray one = camera_ray(frame, x[i], y[i]);
      EXPECT_EQ(rays[i].direction, one.direction);
      EXPECT_EQ(rays[i].origin, one.origin);
      EXPECT_EQ(leaves_out(rays[i]), leaves_out(one));
    }
  }
}

// The depth is the distance from the eye, also behind it.
TEST(CurvedView, DepthCountsFromTheEye) {
  Scene scene = bare_scene();
  scene.film.width = 16, scene.film.height = 8;
  scene.camera.projection = Projection::spherical;
  scene.camera.from = {0, 0, 0}, scene.camera.at = {0, 0, -1};
  scene.integrator.kind = IntegratorKind::depth;
  add_object(scene, SphereShape{{0, 0, 0}, 4}, add_material(scene, diffuse({1, 1, 1})));
  const Picture shown = run(scene).picture;
  for (std::uint32_t y = 0; y < 8; ++y)
    for (std::uint32_t x = 0; x < 16; ++x) EXPECT_NEAR(value(shown, "Z", x, y), 4, 1e-4);
}

TEST(CurvedView, OddViewsStillGiveRays) {
  for (const Projection projection : kCurved)
    for (const std::uint32_t size : {1u, 3u}) {
      Camera camera;
      camera.projection = projection, camera.from = camera.at = {0, 0, 0};
      camera.along_axis = Projection::orthographic;
      const CameraFrame frame = camera_frame(camera, film(size, 1));
      const Ray ray = camera_ray(frame, size / 2.0, 0.5);
      EXPECT_FALSE(leaves_out(ray));
      EXPECT_NEAR(length(ray.direction), 1, 1e-6f);
      EXPECT_TRUE(std::isfinite(frame.pixel_size));
    }
}

}  // namespace
}  // namespace oktett::curved_view_test
