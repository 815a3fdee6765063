/// \file The thin lens: circles of confusion in closed form, distribution over the lens.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/camera.h"
#include "render/sampling/warp.h"
#include "render/transport/wavefront.h"
#include "tests/render/test_scenes.h"

namespace oktett::lens_test {
namespace {

using namespace test;

Film film(std::uint32_t width, std::uint32_t height) {
  Film f;
  f.width = width, f.height = height;
  return f;
}

Camera lens_camera(Projection projection, double aperture, double focus) {
  Camera camera;
  camera.projection = projection;
  camera.from = {1, 2, 3}, camera.at = {-2, 1, -4}, camera.up = {0.1, 1, 0};
  camera.aperture = aperture, camera.focus = focus;
  return camera;
}

/// Where a ray passes the plane at distance `depth` along the view axis.
Vec3d at_depth(const CameraFrame& frame, const Ray& ray, double depth) {
  const Vec3d o(ray.origin), d(ray.direction);
  return o + d * ((depth - dot(o - frame.origin, frame.forward)) / dot(d, frame.forward));
}

// All rays of a film point meet in the plane in focus; elsewhere they fill a disk whose radius is that of the
// lens times |depth - focus| / focus, by similar triangles.
TEST(Lens, RaysOfAPointFillItsCircleOfConfusion) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const double aperture : {1e-3, 0.5, 40.0})
      for (const double focus : {0.1, 3.0, 500.0}) {
        const CameraFrame frame = camera_frame(lens_camera(projection, aperture, focus), film(64, 48));
        const Ray middle = camera_ray(frame, 20.3, 7.9);
        for (const double depth : {0.5 * focus, focus, 3 * focus}) {
          const double radius = aperture / 2 * std::abs(depth - focus) / focus;
          // Directions are floats; the more a ray leans, the more their error counts.
          const double scale = (focus + aperture + depth) * (1 + aperture / focus);
          double farthest = 0;
          for (int i = 0; i < 400; ++i) {
            const double u = (i % 20 + 0.5) / 20, v = (i / 20 + 0.5) / 20;
            const Ray ray = camera_ray(frame, 20.3, 7.9, u, v);
            EXPECT_NEAR(length(ray.direction), 1, 1e-6f);
            const Vec3d away = at_depth(frame, ray, depth) - at_depth(frame, middle, depth);
            // The disk is parallel to the film.
            EXPECT_NEAR(dot(away, frame.forward), 0, 1e-6 * scale);
            farthest = std::max(farthest, length(away));
          }
          EXPECT_LT(farthest, radius + 2e-6 * scale);
          EXPECT_GT(farthest, 0.94 * radius - 2e-6 * scale);
        }
      }
}

// The map of the square to the disk keeps areas: as many points fall into each ring and sector as its area
// says.
TEST(Lens, PointsOfTheDiskAreUniform) {
  constexpr int kSide = 400, kRings = 4, kSectors = 8;
  int count[kRings][kSectors] = {};
  for (int i = 0; i < kSide * kSide; ++i) {
    const SquareSample p = disk_point({(i % kSide + 0.5) / kSide, (i / kSide + 0.5) / kSide});
    const double r = std::hypot(p.x, p.y);
    ASSERT_LE(r, 1 + 1e-12);
    const double turn = std::atan2(p.y, p.x) / (2 * std::numbers::pi) + 0.5;
    ++count[std::min(kRings - 1, static_cast<int>(r * r * kRings))]
           [std::min(kSectors - 1, static_cast<int>(turn * kSectors))];
  }
  for (const auto& ring : count)
    for (const int n : ring) EXPECT_NEAR(n, kSide * kSide / (kRings * kSectors), 0.02 * n);
  // Neighbours stay neighbours across the diagonals, where the map changes.
  for (const double d : {-0.49, -0.2, -0.01, 0.01, 0.2, 0.49})
    for (const double side : {-1.0, 1.0}) {
      const SquareSample p = disk_point({0.5 + d, 0.5 + side * d - 1e-9});
      const SquareSample q = disk_point({0.5 + d, 0.5 + side * d + 1e-9});
      EXPECT_LT(std::hypot(p.x - q.x, p.y - q.y), 1e-7) << d;
    }
  for (const SquareSample& s : {SquareSample{0.5, 0.5}, SquareSample{0, 0}, SquareSample{1 - 1e-16, 0}}) {
    const SquareSample p = disk_point(s);
    EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y));
    EXPECT_LE(std::hypot(p.x, p.y), 1 + 1e-12);
  }
}

// The picture of a small glowing disk out of focus is its share of the lens: radius squared over that of the
// circle of confusion squared.
TEST(Lens, SmallThingsOutOfFocusAreSpread) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    Scene scene = bare_scene(1);
    scene.camera.projection = projection;
    scene.camera.from = {0, 0, 0}, scene.camera.at = {0, 0, -1};
    // A pixel so small that what it sees is a point.
    scene.camera.fov = 1e-4, scene.camera.height = 1e-6;
    scene.camera.aperture = 0.5, scene.camera.focus = 2;
    scene.integrator.samples = 4096;
    add_object(scene, DiskShape{{0, 0, -5}, {0, 0, 1}, 0.1}, add_material(scene, glowing({1, 1, 1})));
    const double radius = 0.25 * (5 - 2) / 2;
    EXPECT_NEAR(value(run(scene).picture, "R", 0, 0), 0.1 * 0.1 / (radius * radius), 0.003);
    // In focus it is as bright as it is.
    scene.camera.focus = 5;
    EXPECT_EQ(value(run(scene).picture, "R", 0, 0), 1);
  }
}

// Rays in lanes have the bits of rays alone, whatever their number; also at the corners and the middle of the
// square, and where its diagonals cross sectors.
TEST(Lens, RaysInLanesHaveTheBitsOfOne) {
  Column<double> x, y, u, v;
  const double odd[] = {0, 0.25, 0.5, 0.75, 1 - 0x1p-32};
  for (int i = 0; i < 333; ++i) {
    x.push_back(0.37 * (i % 64)), y.push_back(0.2 * (i % 48));
    u.push_back(i < 25 ? odd[i % 5] : (i * 7 % 333 + 0.5) / 333);
    v.push_back(i < 25 ? odd[i / 5] : (i * 31 % 333 + 0.5) / 333);
  }
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const CameraFrame frame = camera_frame(lens_camera(projection, 0.5, 3), film(64, 48));
    for (const Isa isa : available_isas())
      for (const std::size_t count : {1u, 7u, 8u, 333u}) {
        RayBatch rays;
        rays.resize_uninitialized(count);
        camera_rays(frame, {x, y, &u, &v}, rays, isa);
        for (std::size_t i = 0; i < count; ++i) {
          const Ray one = camera_ray(frame, x[i], y[i], u[i], v[i]), ray = rays[i];
          EXPECT_EQ(ray.origin, one.origin) << to_string(isa) << ' ' << i;
          EXPECT_EQ(ray.direction, one.direction) << to_string(isa) << ' ' << i;
          EXPECT_EQ(ray.tmin, one.tmin);
          EXPECT_EQ(ray.tmax, one.tmax);
        }
      }
  }
}

// Each camera ray of a wavefront is that of its sample, whatever the order of the rays. If a pixel has 16
// samples or more, rays of one of 16 parts of the lens stand together.
TEST(Lens, RaysAreSortedByPartsOfTheLens) {
  Scene scene = bare_scene(24);
  scene.camera.aperture = 0.3;
  const World world = build_world(scene);
  const SceneLights lights(scene, world);
  for (const std::uint32_t samples : {1u, 15u, 16u, 64u}) {
    scene.integrator.samples = samples;
    const RenderContext context = make_context(scene, world, lights, nullptr, default_isa());
    const std::vector<WavefrontPixel> pixels{{0, 3, 4}, {1, 4, 4}, {2, 20, 11}};
    Wavefront w;
    start_wavefront(context, pixels, 0, samples, w);
    ASSERT_EQ(w.rays.size(), pixels.size() * samples);
    std::vector<int> seen(w.rays.size());
    int last = 0;
    for (std::size_t i = 0; i < w.rays.size(); ++i) {
      const std::uint32_t s = w.rays.sample[i];
      ++seen.at(s);
      const Ray ray = camera_ray(context.camera, w.film_x[s], w.film_y[s], w.lens_x[s], w.lens_y[s]);
      EXPECT_EQ(w.rays.rays[i].origin, ray.origin);
      EXPECT_EQ(w.rays.rays[i].direction, ray.direction);
      const int part = static_cast<int>(w.lens_y[s] * 4) * 4 + static_cast<int>(w.lens_x[s] * 4);
      if (samples >= 16) {
        EXPECT_GE(part, last);
      }
      last = part;
    }
    for (const int times : seen) EXPECT_EQ(times, 1);
  }
}

TEST(Lens, FocusIsADistanceAPointOrWhatTheCameraLooksAt) {
  Camera camera;
  camera.from = {0, 0, 5}, camera.aperture = 1;
  EXPECT_EQ(camera_frame(camera, film(4, 4)).focus, 5);
  camera.focus = 3;
  EXPECT_EQ(camera_frame(camera, film(4, 4)).focus, 3);
  camera.focus_at = Vec3d{7, -2, 1};
  EXPECT_EQ(camera_frame(camera, film(4, 4)).focus, 4);
  // A plane of focus behind the camera is none: the camera is a pinhole.
  camera.focus_at = Vec3d{0, 0, 6};
  EXPECT_EQ(camera_frame(camera, film(4, 4)).lens_radius, 0);
}

// A lens of 50 mm at f/2 has a diameter of 25 mm.
TEST(Lens, FNumbersAreThoseOfPhotography) {
  Camera camera;
  camera.fov = 2 * std::atan(0.012 / 0.05) * 180 / std::numbers::pi;
  camera.f_number = 2;
  EXPECT_NEAR(camera_frame(camera, film(36, 24)).lens_radius, 0.0125, 1e-12);
}

// The same picture for every instruction set, number of threads and crop; the lens does not change what a
// pinhole shows.
TEST(Lens, PicturesHaveTheSameBits) {
  Scene scene = bare_scene(24);
  scene.integrator.samples = 5;
  scene.camera.aperture = 0.3;
  scene.lights = {PointLight{{3, 4, 5}, {1, 1, 1}, false}};
  add_object(scene, SphereShape{{0, 0, 1}, 0.7}, add_material(scene, diffuse({1, 0.5, 0.2f})));
  add_object(scene, PlaneShape{{0, 1, 0}, -1}, 0);
  const Picture one = run(scene, [](RenderOptions& o) { o.threads = 1, o.isa = Isa::scalar; }).picture;
  EXPECT_TRUE(same_bytes(one, run(scene, [](RenderOptions& o) { o.threads = 3; }).picture));
  scene.camera.aperture = 1e-12;
  const Picture sharp = run(scene).picture;
  scene.camera.aperture = 0;
  const Picture pinhole = run(scene).picture;
  double difference = 0;
  for (std::size_t i = 0; i < 24 * 24; ++i)
    difference += std::abs(sharp.find("R")->values[i] - pinhole.find("R")->values[i]);
  EXPECT_LT(difference, 1e-2);
}

}  // namespace
}  // namespace oktett::lens_test
