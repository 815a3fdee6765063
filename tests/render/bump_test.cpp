/// \file Bumps of patterns and images, and normal maps, on surfaces of all kinds.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "kernels/functions/function_tape.h"
#include "tests/render/test_scenes.h"

namespace oktett::bump_test {
namespace {

using test::add_material;
using test::add_object;
using test::bare_scene;

/// Towards three lights of red, green and blue.
constexpr Vec3d kLights[3] = {{0.6, 0, 0.8}, {-0.36, 0.48, 0.8}, {-0.36, -0.48, 0.8}};

/// How an object stands in its scene.
enum class Stands { alone, in_prototype };

/// A scene of one object about the origin, seen from the front.
struct Seen {
  Scene scene = bare_scene(48);
  Picture picture;

  Seen(const Shape& shape, const Affine& transform, const Material& material, const Texture& texture,
       const TextureSampler* sampler = nullptr, Stands stands = Stands::alone) {
    scene.camera.from = {0.3, 0.5, 6};
    for (int k = 0; k < 3; ++k)
      scene.lights.push_back(
          DirectionalLight{-kLights[k], {k == 0 ? 1.0f : 0, k == 1 ? 1.0f : 0, k == 2 ? 1.0f : 0}});
    scene.textures.push_back(texture);
    add_object(scene, shape, add_material(scene, material), transform);
    if (stands == Stands::in_prototype) {
      // A part of the transform is that of the instance.
      const Affine outer = Affine::rotation({10, -20, 30});
      scene.objects[0].transform = outer.inverse() * transform;
      scene.prototypes.push_back({"", std::move(scene.objects)});
      scene.objects.clear();
      add_object(scene, InstanceShape{0}, kNoId, outer);
    }
    picture = test::run(scene, [&](RenderOptions& o) { o.textures = sampler; }).picture;
  }
  /// The normal by which a pixel is lit: each channel is its cosine to one light. Zero where not all reach
  /// it.
  Vec3d lit(std::size_t i) const {
    Vec3d n;
    for (int k = 0; k < 3; ++k) {
      const double cosine = picture.find(k == 0 ? "R" : k == 1 ? "G" : "B")->values[i];
      if (!(cosine > 0)) return {};
      const Vec3d &b = kLights[(k + 1) % 3], &c = kLights[(k + 2) % 3];
      n = n + cross(b, c) * (cosine / dot(kLights[k], cross(b, c)));
    }
    return n;
  }
  Vec3d at(const char* prefix, std::size_t i) const {
    const auto plane = [&](const char* axis) { return picture.find(std::string(prefix) + axis)->values[i]; };
    return {plane(".X"), plane(".Y"), plane(".Z")};
  }
};

Texture linear_heights(const Vec3d& direction, float gain) {
  PatternTexture pattern;
  pattern.pattern = GradientPattern{direction * -50.0, direction * 50.0};
  pattern.colors = {{-50, 0, 0}, {50, 0, 0}};
  Texture texture;
  texture.pattern = pattern;
  texture.gain = gain;
  return texture;
}

/// Expects of the pixels that the normals of `flat` become those of `bent` by `bend`, which gets the place
/// and the normal in the world.
void expect_bent(const Seen& flat, const Seen& bent,
                 const std::function<Vec3d(const Vec3d& place, const Vec3d& normal)>& bend, const char* what,
                 double tolerance = 2e-4) {
  int compared = 0;
  for (std::size_t i = 0; i < 48 * 48; ++i) {
    const Vec3d n = flat.at("N", i), p = flat.at("P", i);
    if (!(length(n) > 0.5)) continue;
    const Vec3d expected = normalize(bend(p, n));
    // Where the bent normal turns away from the viewer, shading bends it less.
    if (dot(expected, normalize(Vec3d{0.3, 0.5, 6} - p)) < 0.05) continue;
    const Vec3d found = bent.lit(i);
    if (found == Vec3d{0, 0, 0}) continue;
    EXPECT_LT(length(found - expected), tolerance) << what << " pixel " << i;
    ++compared;
  }
  EXPECT_GT(compared, 100) << what;
}

/// The direction (x, y, z) by the transposed matrix: normals are mapped by the inverse of that.
Vec3d by_transpose(const Affine& a, const Vec3d& n) {
  Vec3d sum;
  for (int k = 0; k < 3; ++k) sum[k] = a.m[0][k] * n.x + a.m[1][k] * n.y + a.m[2][k] * n.z;
  return sum;
}

/// Compares the bent normals with those of the plain surface, tilted in the object's own space.
void expect_bumps(const Shape& shape, const Affine& map, const char* what, Stands stands = Stands::alone) {
  const Vec3d direction = normalize(Vec3d{0.3, 0.8, 0.5});
  Material plain = test::diffuse({1, 1, 1}), bumpy = plain;
  bumpy.bump_texture = 0;
  bumpy.bump_scale = 2;
  const Texture heights = linear_heights(direction, 0.25f);
  const Seen flat(shape, map, plain, heights, nullptr, stands);
  const Seen bent(shape, map, bumpy, heights, nullptr, stands);
  // In a prototype the object's own space is that of the shape, too.
  const auto bend = [&](const Vec3d&, const Vec3d& n) {
    const Vec3d own = normalize(by_transpose(map, n));
    const Vec3d along = direction - own * dot(direction, own);
    return by_transpose(map.inverse(), own - along * 0.5);
  };
  expect_bent(flat, bent, bend, what);
}

Shape exact(auto form) { return ExactShape{form, NormalMethod::gradient}; }

/// Heights that a mesh carries, which grow evenly along a direction, bend it as those of space do.
TEST(AttributeBump, TiltsTheNormalsOfTriangles) {
  const Vec3d direction = normalize(Vec3d{0.3, 0.8, 0.5});
  const Affine map = Affine::rotation({20, 30, 40}) * Affine::scaling({1.5, 1, 0.8});
  auto mesh = test::sphere_mesh(9);
  MeshAttribute heights;
  heights.name = "height";
  for (const Vec3f& p : mesh->positions)
    heights.floats.push_back(static_cast<float>(dot(Vec3d(p), direction)));
  mesh->attributes.push_back(heights);
  MeshShape shape;
  shape.mesh = mesh, shape.smooth = false;
  Material plain = test::diffuse({1, 1, 1}), bumpy = plain;
  bumpy.bump_texture = 0;
  bumpy.bump_scale = 2;
  Texture texture;
  texture.attribute = "height", texture.gain = 0.25f;
  for (const Stands stands : {Stands::alone, Stands::in_prototype}) {
    const Seen flat(shape, map, plain, texture, nullptr, stands);
    const Seen bent(shape, map, bumpy, texture, nullptr, stands);
    const auto bend = [&](const Vec3d&, const Vec3d& n) {
      const Vec3d own = normalize(by_transpose(map, n));
      const Vec3d along = direction - own * dot(direction, own);
      return by_transpose(map.inverse(), own - along * 0.5);
    };
    expect_bent(flat, bent, bend, "mesh");
  }
}

TEST(PatternBump, TiltsTheNormalsOfEverySurface) {
  const Affine map = Affine::rotation({20, 30, 40}) * Affine::scaling({1.5, 1, 0.8});
  expect_bumps(SphereShape{}, {}, "sphere");
  expect_bumps(SphereShape{}, map, "ellipsoid");
  expect_bumps(BoxShape{}, map, "box");
  expect_bumps(exact(TorusShape{}), map, "torus");
  auto operands = std::make_shared<std::vector<Object>>(2);
  // Operands have materials of their own.
  (*operands)[0].material = (*operands)[1].material = 0;
  (*operands)[0].shape = SphereShape{};
  (*operands)[1].shape = SphereShape{{0.6, 0.6, 0.6}, 0.8};
  expect_bumps(CsgShape{CsgOp::unite, operands}, map, "combination");
  ImplicitShape implicit;
  implicit.function = compile_function("x^4 + y^4 + z^4 - 1");
  implicit.lo = {-1.5, -1.5, -1.5}, implicit.hi = {1.5, 1.5, 1.5};
  expect_bumps(exact(implicit), map, "implicit");
  expect_bumps(exact(implicit), map, "implicit in a prototype", Stands::in_prototype);
  expect_bumps(exact(TorusShape{}), map, "torus in a prototype", Stands::in_prototype);
  expect_bumps(exact(TorusShape{}), Affine::scaling({1, -1.3, 1}) * map, "mirrored torus");
}

// --- images

/// Images given by functions: heights that rise by `along_u` and `along_v` per unit of uv, and one normal.
class Slopes final : public TextureSampler {
 public:
  Slopes(float along_u, float along_v, const Vec3f& normal = {})
      : along_u_(along_u), along_v_(along_v), normal_(normal) {}
  Color color(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return {1, 1, 1}; }
  float value(std::uint32_t, Vec2f uv, Vec2f, Vec2f) const override {
    return along_u_ * uv.x + along_v_ * uv.y;
  }
  Vec3f normal(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return normal_; }

 private:
  float along_u_, along_v_;
  Vec3f normal_;
};

constexpr double kMajor = 0.8, kMinor = 0.4;

Shape ring() {
  TorusShape torus;
  torus.major = kMajor, torus.minor = kMinor;
  return exact(torus);
}

/// The derivative of the ring's place by u, in the world.
Vec3d around_ring(const Affine& map, const Vec3d& place) {
  const Vec3d p = map.inverse().point(place);
  return map.vector(Vec3d{-p.y, p.x, 0} * (2 * std::numbers::pi));
}

/// Its derivative by v.
Vec3d around_tube(const Affine& map, const Vec3d& place) {
  const Vec3d p = map.inverse().point(place), out = Vec3d{p.x, p.y, 0} / std::hypot(p.x, p.y);
  return map.vector((out * -p.z + Vec3d{0, 0, std::hypot(p.x, p.y) - kMajor}) * (2 * std::numbers::pi));
}

/// A ring that a box cuts.
Shape cut_ring() {
  auto operands = std::make_shared<std::vector<Object>>(2);
  (*operands)[0].material = (*operands)[1].material = 0;
  (*operands)[0].shape = ring();
  (*operands)[1].shape = BoxShape{{0.1, 0.1, -1}, {2, 2, 1}};
  return CsgShape{CsgOp::subtract, operands};
}

// A height h of the image displaces the surface along its normal: dp/du becomes dp/du + n dh/du.
TEST(ImageBump, TiltsNormalsAlongTheTangent) {
  Material plain = test::diffuse({1, 1, 1}), bumpy = plain;
  bumpy.bump_texture = 0, bumpy.bump_scale = 0.5f;
  const Affine map = Affine::rotation({60, 30, 40}) * Affine::scaling({1.3, 1.3, 1.3});
  const auto compare = [&](const Shape& shape, const Affine& at, Stands stands, const char* what) {
    const Slopes along_u(2, 0), along_v(0, 2);
    const Seen flat(shape, at, plain, {}, nullptr, stands);
    const auto on_ring = [&](const Vec3d& place) {
      const Vec3d p = at.inverse().point(place);
      return std::abs(std::hypot(std::hypot(p.x, p.y) - kMajor, p.z) - kMinor) < 1e-4;
    };
    const auto bend_u = [&](const Vec3d& place, const Vec3d& n) {
      const Vec3d by_u = around_ring(at, place);
      return on_ring(place) ? n * dot(by_u, by_u) - by_u : Vec3d{0, 0, -1};
    };
    expect_bent(flat, {shape, at, bumpy, {}, &along_u, stands}, bend_u, what, 1e-3);
    const auto bend_v = [&](const Vec3d& place, const Vec3d& n) {
      const Vec3d by_v = around_tube(at, place);
      return on_ring(place) ? n * dot(by_v, by_v) - by_v : Vec3d{0, 0, -1};
    };
    expect_bent(flat, {shape, at, bumpy, {}, &along_v, stands}, bend_v, what, 1e-3);
  };
  compare(ring(), map, Stands::alone, "ring");
  compare(ring(), map * Affine::scaling({-1, 1, 1}), Stands::alone, "mirrored ring");
  compare(ring(), map, Stands::in_prototype, "ring in a prototype");
  compare(cut_ring(), map, Stands::alone, "cut ring");
}

TEST(ImageNormals, StandInTheFrameOfTheTangent) {
  Material plain = test::diffuse({1, 1, 1}), mapped = plain;
  mapped.normal_texture = 0;
  const Affine map = Affine::rotation({60, 30, 40}) * Affine::scaling({1.3, 1.3, 1.3});
  const Slopes texture(0, 0, {0.5f + 0.24f, 0.5f + 0.18f, 0.5f + 0.4f});
  for (const Stands stands : {Stands::alone, Stands::in_prototype})
    for (const Affine& at : {map, map * Affine::scaling({1, 1, -1})}) {
      const auto bend = [&](const Vec3d& place, const Vec3d& n) {
        return normalize(around_ring(at, place)) * 0.48 + normalize(around_tube(at, place)) * 0.36 + n * 0.8;
      };
      expect_bent({ring(), at, plain, {}, nullptr, stands}, {ring(), at, mapped, {}, &texture, stands}, bend,
                  "ring");
    }
}

// Without texture coordinates there is no direction in which an image's heights could rise.
TEST(ImageBump, SurfacesWithoutCoordinatesStayAsTheyAre) {
  Material plain = test::diffuse({1, 1, 1}), bumpy = plain;
  bumpy.bump_texture = bumpy.normal_texture = 0;
  const Slopes texture(3, 2, {0.9f, 0.5f, 0.7f});
  ImplicitShape implicit;
  implicit.function = compile_function("x^4 + y^4 + z^4 - 1");
  implicit.lo = {-1.5, -1.5, -1.5}, implicit.hi = {1.5, 1.5, 1.5};
  const auto same = [](const Vec3d&, const Vec3d& n) { return n; };
  expect_bent({exact(implicit), {}, plain, {}}, {exact(implicit), {}, bumpy, {}, &texture}, same, "implicit");
}

}  // namespace
}  // namespace oktett::bump_test
