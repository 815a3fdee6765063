/// \file Motion blur: interpolated transforms, coverage of what moves in closed form, moving lights and
/// cameras.

#include "render/motion.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "accel/build/refit.h"
#include "render/geometry.h"
#include "render/moments.h"
#include "render/sampling/owen_sobol.h"
#include "tests/render/test_scenes.h"
#include "tests/support/dice.h"
#include "tests/support/grid_triangles.h"

namespace oktett::motion_test {
namespace {

using namespace test;

MotionPointer motion(std::vector<MotionKey> keys) {
  return std::make_shared<const Motion>(Motion{{std::move(keys)}});
}

MotionPointer from_to(const Affine& from, const Affine& to) { return motion({{0, from}, {1, to}}); }

double difference(const Affine& a, const Affine& b) {
  double greatest = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) greatest = std::max(greatest, std::abs(a.m[i][j] - b.m[i][j]));
  return greatest;
}

TEST(Motion, RotationsTurnAtConstantSpeed) {
  for (const Vec3d& axis : {Vec3d{0, 0, 1}, Vec3d{1, 2, -3}, Vec3d{-1, 0, 1e-3}})
    for (const double angle : {1e-7, 30.0, 120.0, 179.0})
      for (const double t : {0.1, 0.5, 0.9}) {
        const Affine start = Affine::rotation(Vec3d{10, 20, 30}) * Affine::scaling({2, 3, 0.5});
        const MotionPointer turn = from_to(start, Affine::rotation(axis, angle) * start);
        EXPECT_LT(difference(turn->at(t), Affine::rotation(axis, angle * t) * start), 1e-12) << angle;
      }
}

TEST(Motion, TranslationAndStretchChangeLinearly) {
  const Affine turn = Affine::rotation(Vec3d{50, -70, 10});
  const MotionPointer grow = from_to(Affine::translation({1, 0, 4}) * turn * Affine::scaling({1, 2, 3}),
                                     Affine::translation({3, 2, 0}) * turn * Affine::scaling({5, 2, 1}));
  EXPECT_LT(
      difference(grow->at(0.25), Affine::translation({1.5, 0.5, 3}) * turn * Affine::scaling({2, 2, 2.5})),
      1e-12);
  // A mirror stays one.
  const MotionPointer mirrored = from_to(Affine::scaling({-1, 1, 1}), Affine::scaling({-3, 1, 1}));
  EXPECT_LT(difference(mirrored->at(0.5), Affine::scaling({-2, 1, 1})), 1e-12);
}

TEST(Motion, KeysAreKeptAndEndsHold) {
  const Affine a = Affine::rotation(Vec3d{1, 2, 3}), b = Affine::scaling({1e6, 1e-6, 1}),
               c = Affine::translation({7, 8, 9});
  const MotionPointer m = motion({{-1, a}, {0.5, b}, {2, c}});
  EXPECT_EQ(m->at(-1), a);
  EXPECT_EQ(m->at(0.5), b);
  EXPECT_EQ(m->at(2), c);
  EXPECT_EQ(m->at(-50), a);
  EXPECT_EQ(m->at(50), c);
  EXPECT_TRUE(m->moves());
  EXPECT_FALSE(motion({{3, a}})->moves());
  const Motion chain{{{{0, c}}, {{0, a}, {1, b}}}};
  EXPECT_EQ(chain.at(1), c * b);
}

RC_GTEST_PROP(Motion, EverythingBetweenRegularKeysIsRegular, ()) {
  const auto number = [] { return *rc::gen::inRange(-1000, 1000) / 100.0; };
  const auto affine = [&] {
    Affine a;
    for (auto& row : a.m)
      for (double& v : row) v = number();
    return a;
  };
  const Affine a = affine(), b = affine();
  RC_PRE(std::abs(a.determinant()) > 1e-3 && std::abs(b.determinant()) > 1e-3);
  RC_PRE((a.determinant() < 0) == (b.determinant() < 0));
  const MotionPointer m = from_to(a, b);
  for (const double t : {1e-9, 0.3, 0.5, 0.7, 1 - 1e-9}) {
    RC_ASSERT(m->at(t).is_invertible());
    RC_ASSERT((m->at(t).determinant() < 0) == (a.determinant() < 0));
  }
  // No jump at the keys, also where rotations are half a turn apart.
  RC_ASSERT(difference(m->at(1e-9), a) < 1e-5);
  RC_ASSERT(difference(m->at(1 - 1e-9), b) < 1e-5);
}

/// Pixels of side 0.25 on the plane z = 0.
Scene plane_scene(std::uint32_t samples) {
  Scene scene = bare_scene(32);
  scene.film.height = 2;
  scene.camera.projection = Projection::orthographic;
  scene.camera.height = 0.5;
  scene.integrator.samples = samples;
  return scene;
}

/// The part of the time, and of the pixel from x to x + 0.25, in which |x - place(t)| < 1.
template <class Place>
double coverage(double x, const Place& place) {
  constexpr int kSteps = 500;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double middle = place((i + 0.5) / kSteps);
    sum += std::max(0.0, std::min(x + 0.25, middle + 1) - std::max(x, middle - 1)) / 0.25;
  }
  return sum / kSteps;
}

// A glowing square of side 2 moves by 3 to the right: each pixel shows how long it is covered.
TEST(MotionBlur, ASquareCoversWhereItIs) {
  const PolygonShape square{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}};
  for (const bool as_instance : {false, true})
    for (const bool with_plane : {false, true}) {
      Scene scene = plane_scene(1024);
      const std::uint32_t glow = add_material(scene, glowing({1, 0.5f, 0.25f}));
      // A second, still body, which gives no light.
      if (with_plane) add_object(scene, PlaneShape{{0, 0, 1}, -1}, add_material(scene, diffuse({0, 0, 0})));
      if (as_instance) {
        scene.prototypes.push_back({"square", {}});
        Object object;
        object.shape = square, object.material = glow;
        scene.prototypes[0].objects.push_back(object);
        add_object(scene, InstanceShape{0}, kNoId);
      } else {
        add_object(scene, square, glow);
      }
      scene.objects.back().motion = from_to({}, Affine::translation({3, 0, 0}));
      const Picture p = run(scene).picture;
      for (std::uint32_t x = 0; x < 32; ++x) {
        const double expected = coverage(-4 + x * 0.25, [](double t) { return 3 * t; });
        EXPECT_NEAR(value(p, "R", x, 1), expected, 0.02) << x;
        EXPECT_EQ(value(p, "G", x, 1), value(p, "R", x, 1) / 2);
        EXPECT_NEAR(value(p, "A", x, 0), with_plane ? 1 : expected, 0.02);
      }
    }
}

// The shutter is open for a part of the motion only, and the motion has several keys.
TEST(MotionBlur, TheShutterCutsTheMotion) {
  Scene scene = plane_scene(640);
  scene.camera.shutter[0] = 0.25, scene.camera.shutter[1] = 0.75;
  add_object(scene, BoxShape{{-1, -1, -1}, {1, 1, 0}}, add_material(scene, glowing({1, 1, 1})));
  scene.objects[0].motion =
      motion({{0, Affine::translation({-2, 0, 0})}, {0.5, {}}, {1, Affine::translation({4, 0, 0})}});
  const Picture p = run(scene).picture;
  const auto place = [](double t) { return t < 0.5 ? -1 + 2 * t : 4 * (t - 0.5); };
  for (std::uint32_t x = 0; x < 32; ++x)
    EXPECT_NEAR(value(p, "R", x, 0), coverage(-4 + x * 0.25, place), 0.02) << x;
  // A shutter that is open for a moment makes a sharp picture.
  scene.camera.shutter[0] = scene.camera.shutter[1] = 1;
  scene.integrator.samples = 16;
  const Picture sharp = run(scene).picture;
  EXPECT_EQ(value(sharp, "R", 30, 0), 1);
  EXPECT_EQ(value(sharp, "R", 20, 0), 0);
}

// Numbers of samples that the moments do not divide evenly weigh all times alike.
TEST(MotionBlur, EachMomentStandsForItsShareOfTime) {
  for (const std::uint32_t samples : {1u, 2u, 7u, 64u, 65u, 129u, 1000u, 65536u}) {
    const std::uint32_t moments = std::min(samples, kMostMoments);
    EXPECT_EQ(first_sample_of_moment(0, moments, samples), 0u);
    EXPECT_EQ(first_sample_of_moment(moments, moments, samples), samples);
    for (std::uint32_t m = 0; m < moments; ++m)
      EXPECT_LT(first_sample_of_moment(m, moments, samples), first_sample_of_moment(m + 1, moments, samples));
  }
  Scene scene = bare_scene();
  scene.integrator.samples = 100;
  scene.camera.motion = from_to({}, Affine::translation({1, 0, 0}));
  World world = build_world(scene);
  const Moments moments(scene, world, {});
  ASSERT_EQ(moments.times().size(), 64u);
  for (std::uint32_t m = 0; m < 64; ++m) {
    EXPECT_GE(moments.times()[m], first_sample_of_moment(m, 64, 100) / 100.0);
    EXPECT_LT(moments.times()[m], first_sample_of_moment(m + 1, 64, 100) / 100.0);
  }
}

// The samples of a moment are consecutive, so those of 16 moments of four lie one each in the quarters of the
// pixel.
TEST(MotionBlur, SamplesOfAMomentAreStratified) {
  for (std::uint64_t key = 1; key < 100; ++key)
    for (std::uint32_t m = 0; m < 16; ++m) {
      int seen = 0;
      for (std::uint32_t s = first_sample_of_moment(m, 16, 64); s < first_sample_of_moment(m + 1, 16, 64);
           ++s) {
        const SquareSample at = sobol_point(s, mix_bits(key));
        seen |= 1 << ((at.x < 0.5 ? 0 : 1) + (at.y < 0.5 ? 0 : 2));
      }
      EXPECT_EQ(seen, 15);
    }
}

/// Three bodies, a mesh among them, and a lamp.
Scene busy_scene() {
  Scene scene = bare_scene(24);
  scene.integrator.samples = 9;
  scene.camera.from = {1, 2, 5};
  scene.lights = {PointLight{{3, 4, 5}, {1, 1, 1}, false}};
  const std::uint32_t grey = add_material(scene, diffuse({0.5, 0.6f, 0.7f}));
  MeshShape ball;
  ball.mesh = sphere_mesh(8);
  add_object(scene, ball, grey, Affine::translation({-1, 0, 0}));
  add_object(scene, SphereShape{{0.8, 0, 0}, 0.7}, grey);
  add_object(scene, PlaneShape{{0, 1, 0}, -1}, grey);
  return scene;
}

// Where all that is seen moves one way, it looks as if the camera moved the other way.
TEST(MotionBlur, ACameraMovesAgainstTheWorld) {
  Scene by_camera = busy_scene();
  by_camera.objects.pop_back();
  const Affine move = Affine::translation({0.4, -0.2, 0.3}) * Affine::rotation(Vec3d{0, 20, 0});
  by_camera.camera.motion = motion({{0, {}}, {1, move}});
  Scene by_world = by_camera;
  by_world.camera.motion = nullptr;
  by_world.light_traits.resize(1);
  // The inverse of the interpolated motion as many keys, so that what is between them does not matter.
  std::vector<MotionKey> keys, first;
  for (int i = 0; i <= 400; ++i) {
    const Affine back = by_camera.camera.motion->at(i / 400.0).inverse();
    keys.push_back({i / 400.0, back});
    first.push_back({i / 400.0, back * by_world.objects[0].transform});
  }
  by_world.objects[0].motion = motion(first), by_world.objects[1].motion = motion(keys);
  by_world.light_traits[0].motion = motion(keys);
  const Picture a = run(by_camera).picture, b = run(by_world).picture;
  double difference = 0, light = 0;
  for (std::size_t i = 0; i < a.find("R")->values.size(); ++i) {
    difference += std::abs(static_cast<double>(a.find("R")->values[i] - b.find("R")->values[i]));
    light += static_cast<double>(a.find("R")->values[i]);
  }
  EXPECT_GT(light, 10);
  EXPECT_LT(difference, 0.005 * light);
}

// A lamp that moves lights what is below it for the time that it is there.
TEST(MotionBlur, MovingLampsLightWhereTheyAre) {
  const auto floor = [](const char* kind) {
    Scene scene = bare_scene(1);
    scene.integrator.kind = std::string(kind) == "path" ? IntegratorKind::path : IntegratorKind::whitted;
    scene.integrator.samples = 4096, scene.integrator.depth = 0;
    scene.camera.from = {0, 0.4, 5}, scene.camera.at = {0, 0, 0}, scene.camera.fov = 0.001;
    add_object(scene, DiskShape{{0, 0, 0}, {0, 1, 0}, 0.05}, add_material(scene, diffuse({1, 1, 1})));
    return scene;
  };
  // The mean over t of cos / r^2 at (4 t, 2, 0).
  double expected = 0;
  for (int i = 0; i < 100000; ++i) {
    const double x = 4 * (i + 0.5) / 100000, square = x * x + 4;
    expected += 2 / (square * std::sqrt(square)) / 100000;
  }
  const MotionPointer fly = from_to({}, Affine::translation({4, 0, 0}));
  for (const char* kind : {"whitted", "path"}) {
    Scene scene = floor(kind);
    scene.lights = {DirectionalLight{{0, -1, 0}, {0, 0, 0}, 0}, PointLight{{0, 2, 0}, {1, 1, 1}, true}};
    scene.light_traits = {{}, {fly}};
    EXPECT_NEAR(value(run(scene).picture, "G", 0, 0), expected, 0.01 * expected) << kind;
  }
  // A small glowing sphere has the same intensity per pi: radiance * radius^2.
  Scene scene = floor("path");
  const float radiance = 1 / (0.05f * 0.05f);
  add_object(scene, SphereShape{{0, 2, 0}, 0.05},
             add_material(scene, glowing({radiance, radiance, radiance})));
  scene.objects.back().motion = fly;
  EXPECT_NEAR(value(run(scene).picture, "G", 0, 0), expected, 0.01 * expected);
}

TEST(MotionBlur, ObjectsKeepTheirNumbers) {
  Scene scene = busy_scene();
  scene.integrator.samples = 4;
  const Picture still = run(scene).picture;
  scene.objects[0].motion =
      from_to(scene.objects[0].transform, Affine::translation({0, 1e-6, 0}) * scene.objects[0].transform);
  const Picture moving = run(scene).picture;
  std::size_t same = 0;
  const auto &a = still.find("geomID.I")->ids, &b = moving.find("geomID.I")->ids;
  for (std::size_t i = 0; i < a.size(); ++i) same += a[i] == b[i] ? 1 : 0;
  EXPECT_GE(same, a.size() - 2);
}

/// A grid that waves, then is crumpled: vertices change places at random.
MeshShape waving_grid(std::uint32_t n) {
  auto mesh = std::make_shared<TriangleMesh>();
  auto bending = std::make_shared<MeshBending>();
  Dice<float> dice(5);
  bending->poses.resize(3);
  for (std::size_t k = 0; k < 3; ++k) {
    MeshPose& pose = bending->poses[k];
    pose.time = static_cast<double>(k);
    for (std::uint32_t i = 0; i < (n + 1) * (n + 1); ++i) {
      const float x = static_cast<float>(i % (n + 1)) / static_cast<float>(n),
                  y = static_cast<float>(i / (n + 1)) / static_cast<float>(n);
      pose.positions.push_back(k == 2 ? dice.vec(1) : Vec3f{x, y, k == 0 ? 0 : 0.2f * std::sin(9 * x)});
    }
  }
  mesh->positions = bending->poses[0].positions;
  add_grid_triangles(*mesh, n);
  MeshShape shape;
  shape.mesh = std::move(mesh), shape.bending = std::move(bending);
  return shape;
}

TEST(MotionBlur, BentMeshesHaveTheHitsOfTreesBuiltForTheirTime) {
  const MeshShape shape = waving_grid(20);
  Scene scene = bare_scene();
  add_object(scene, shape, add_material(scene, diffuse({0.5f, 0.5f, 0.5f})));
  World world = build_world(scene);
  ASSERT_EQ(world.moving.size(), 1u);
  Dice<float> dice(7);
  int hit = 0;
  std::vector<std::shared_ptr<const Accel>> kept;
  for (const double time : {0.1, 0.5, 1.0, 1.05, 1.5, 2.0, 0.7}) {
    const auto links = [&] { return world.moving[0].following->tree(); };
    const std::shared_ptr<const Accel> before = links();
    const double cost = stats(*before).sah_cost;
    pose(world, time);
    kept.push_back(before);
    // While it waves, the tree is that of the flat grid.
    if (time <= 1) {
      EXPECT_LE(stats(*links()).sah_cost, 1.5 * cost) << time;
    }
    const std::shared_ptr<const TriangleMesh> mesh = mesh_at(shape, time);
    const auto fresh = build_accel({{MeshGeometry{mesh.get()}, {}, 0}});
    for (int i = 0; i < 3000; ++i) {
      const Vec3f from = dice.vec(2);
      const Ray ray{from, 0, Vec3f{dice(), dice(), 0} - from, 100};
      const Hit expected = closest_hit(*fresh, ray), found = closest_hit(*world.moving[0].shape, ray);
      EXPECT_EQ(found, expected) << time << ' ' << i;
      hit += expected.valid() ? 1 : 0;
    }
  }
  EXPECT_GT(hit, 15000);
  // Trees of other moments stay as they are.
  const std::shared_ptr<const TriangleMesh> flat = mesh_at(shape, 0);
  const Ray down{{0.31f, 0.42f, 1}, 0, {0, 0, -1}, 10};
  EXPECT_EQ(closest_hit(*kept[0], down),
            closest_hit(*build_accel({{MeshGeometry{flat.get()}, {}, 0}}), down));
}

TEST(MotionBlur, PicturesHaveTheSameBits) {
  Scene scene = busy_scene();
  scene.objects[0].motion = from_to(scene.objects[0].transform, Affine::rotation(Vec3d{0, 40, 0}));
  scene.objects[1].motion = from_to({}, Affine::translation({0, 0.5, 0}));
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path}) {
    scene.integrator.kind = kind;
    for (const bool layers : {true, false}) {
      const auto with = [&](unsigned threads, Isa isa, std::uint32_t tile) {
        return run(scene,
                   [&](RenderOptions& o) {
                     o.threads = threads, o.isa = isa, o.tile_size = tile, o.data_layers = layers;
                   })
            .picture;
      };
      EXPECT_TRUE(same_bytes(with(1, Isa::scalar, 32), with(2, default_isa(), 7)));
    }
  }
}

}  // namespace
}  // namespace oktett::motion_test
