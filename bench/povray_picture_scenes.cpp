#include "bench/povray_picture_scenes.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "bench/bench_mesh.h"

namespace oktett::bench {
namespace {

constexpr double kHorizontal = 40;  // degrees of view
constexpr std::uint32_t kDepth = 5;
constexpr std::uint32_t kLong = 1024;  ///< samples of a run that others are compared with

std::string text_of(const Vec3d& p) { return fmt::format("<{}, {}, {}>", p.x, p.y, p.z); }

Scene empty_scene(std::uint32_t width, std::uint32_t height, const Vec3d& from, const Vec3d& at) {
  Scene scene;
  scene.camera.from = from, scene.camera.at = at, scene.camera_given = scene.lights_given = true;
  const double half = std::tan(kHorizontal * std::numbers::pi / 360) * height / width;
  scene.camera.fov = std::atan(half) * 360 / std::numbers::pi;
  scene.film.width = width, scene.film.height = height;
  scene.integrator.depth = kDepth;
  scene.ambient_light = {0, 0, 0};
  return scene;
}

/// `lens`: more words of the camera.
std::string pov_head(const Scene& scene, const std::string& lens = {}) {
  return fmt::format(
      "#version 3.7;\nglobal_settings {{ assumed_gamma 1.0 max_trace_level {} adc_bailout 1/4096 }}\n"
      "camera {{ location {} right x*image_width/image_height angle {} look_at {} {} }}\n"
      "background {{ rgb {} }}\n",
      kDepth + 1, text_of(scene.camera.from), kHorizontal, text_of(scene.camera.at), lens,
      text_of(Vec3d(scene.background)));
}

std::uint32_t add(Scene& scene, Shape shape, const Material& material) {
  scene.materials.push_back(material);
  scene.objects.emplace_back().shape = std::move(shape);
  scene.objects.back().material = static_cast<std::uint32_t>(scene.materials.size() - 1);
  return scene.objects.back().material;
}

Material dull(const Color& color) {
  Material m;
  m.color = color, m.ambient = 0, m.diffuse = 0.8f;
  return m;
}

std::string pov_dull(const Color& c) {
  return fmt::format("pigment {{ rgb {} }} finish {{ ambient 0 diffuse 0.8 }}", text_of(Vec3d(c)));
}

const Color kFloor{0.6f, 0.6f, 0.65f};
std::string pov_floor(double height) {
  return fmt::format("plane {{ y, {} {} }}\n", height, pov_dull(kFloor));
}

/// The balls of the Standard Procedural Databases (Haines 1987): nine balls of a third of the radius sit on
/// each ball, six around its middle and three above.
void add_balls(const Vec3d& center, double radius, const Vec3d& axis, int levels, SpheresShape& balls) {
  balls.spheres.push_back({center, radius});
  if (levels == 0) return;
  Vec3d x, y;
  make_basis(axis, x, y);
  for (int k = 0; k < 9; ++k) {
    const double turn = (k < 6 ? k : k + 0.25) * std::numbers::pi * (k < 6 ? 2.0 / 6 : 2.0 / 3);
    const double up = k < 6 ? 0 : 0.8164965809277261;
    const Vec3d out =
        normalize((x * std::cos(turn) + y * std::sin(turn)) * std::sqrt(1 - up * up) + axis * up);
    add_balls(center + out * (radius * 4 / 3), radius / 3, out, levels - 1, balls);
  }
}

PictureScene balls(std::uint32_t width, std::uint32_t height, int levels) {
  SpheresShape shape;
  add_balls({0, 0, 0}, 0.5, {0, 1, 0}, levels, shape);
  PictureScene p;
  p.name = fmt::format("balls_{}", shape.spheres.size());
  p.mirrors = true;
  p.scene = empty_scene(width, height, {2.1, 1.3, -1.7}, {0, 0, 0});
  p.scene.background = {0.08f, 0.2f, 0.3f};
  p.scene.lights = {PointLight{{4, 6, -3}}};
  Material mirror = dull({1, 0.9f, 0.7f});
  mirror.diffuse = 0.4f, mirror.reflection = 0.5f;
  std::string text = pov_head(p.scene) +
                     "light_source { <4, 6, -3> rgb 1 }\n"
                     "#declare T = texture { pigment { rgb <1, 0.9, 0.7> } finish { ambient 0 diffuse 0.4 "
                     "reflection 0.5 } }\n" +
                     pov_floor(-0.5);
  // Nine digits are those of a float, and both read the same ones.
  for (SphereShape& s : shape.spheres) {
    const std::string numbers =
        fmt::format("<{:.9g}, {:.9g}, {:.9g}>, {:.9g}", s.center.x, s.center.y, s.center.z, s.radius);
    text += "sphere { " + numbers + " texture { T } }\n";
  }
  add(p.scene, std::move(shape), mirror);
  add(p.scene, PlaneShape{{0, 1, 0}, -0.5}, dull(kFloor));
  p.pov = [text](std::uint32_t) { return text; };
  return p;
}

/// Dull balls of many colours on a floor, and what stands between them.
std::string add_field(Scene& scene, int side) {
  std::string text = pov_floor(0);
  for (int i = 0; i < side; ++i)
    for (int k = 0; k < side; ++k) {
      const Color color{0.3f + 0.7f * static_cast<float>(i) / static_cast<float>(side), 0.5f,
                        1 - 0.7f * static_cast<float>(k) / static_cast<float>(side)};
      const Vec3d center{1.0 * (i - side / 2), 0.4, 1.0 * (k - side / 2)};
      add(scene, SphereShape{center, 0.4}, dull(color));
      text += fmt::format("sphere {{ {}, 0.4 {} }}\n", text_of(center), pov_dull(color));
    }
  add(scene, PlaneShape{}, dull(kFloor));
  return text;
}

Material clear_glass() {
  Material clear = dull({1, 1, 1});
  clear.diffuse = 0, clear.transparency = 1, clear.ior = 1.5f;
  return clear;
}

constexpr const char* kPovGlass =
    " texture { pigment { rgbt <1, 1, 1, 1> } finish { ambient 0 diffuse 0 reflection { 0, 1 fresnel on } "
    "conserve_energy } } interior { ior 1.5 }";

PictureScene glass(std::uint32_t width, std::uint32_t height) {
  PictureScene p;
  p.name = "glass";
  p.scene = empty_scene(width, height, {1, 4, -9}, {0, 0.5, 0});
  p.scene.background = {0.1f, 0.2f, 0.3f};
  p.scene.lights = {PointLight{{-20, 40, -20}}};
  std::string text = pov_head(p.scene) + "light_source { <-20, 40, -20> rgb 1 }\n" + add_field(p.scene, 11);
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < 6; ++k) {
      const Vec3d center{i - 2.5, 1.1, k - 2.5};
      add(p.scene, SphereShape{center, 0.45}, clear_glass());
      text += fmt::format("sphere {{ {}, 0.45{} }}\n", text_of(center), kPovGlass);
    }
  p.pov = [text](std::uint32_t) { return text; };
  return p;
}

/// POV-Ray's text of the mesh. The vector tells it which side is inside.
std::string pov_mesh(const TriangleMesh& mesh) {
  std::string text = fmt::format("mesh2 {{ vertex_vectors {{ {}", mesh.positions.size());
  for (const Vec3f& p : mesh.positions) text += fmt::format(", <{:.9g}, {:.9g}, {:.9g}>", p.x, p.y, p.z);
  text += fmt::format(" }} face_indices {{ {}", mesh.indices.size() / 3);
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    text += fmt::format(", <{}, {}, {}>", mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]);
  return text + " } inside_vector <0, 1, 0>";
}

/// The mesh of the benchmarks, of glass, over the field.
PictureScene glass_mesh(std::uint32_t width, std::uint32_t height) {
  PictureScene p;
  p.name = "glass_mesh";
  p.scene = empty_scene(width, height, {1, 4, -9}, {0, 1.2, 0});
  p.scene.background = {0.1f, 0.2f, 0.3f};
  p.scene.lights = {PointLight{{-20, 40, -20}}};
  std::string text = pov_head(p.scene) + "light_source { <-20, 40, -20> rgb 1 }\n" + add_field(p.scene, 11);
  auto mesh = std::make_shared<TriangleMesh>(bench_mesh());
  for (std::size_t i = 0; i < mesh->positions.size(); ++i)
    mesh->positions[i] = mesh->positions[i] * 1.8f + Vec3f{0, 2.8f, 0};
  text += pov_mesh(*mesh) + kPovGlass + " }\n";
  add(p.scene, MeshShape{std::move(mesh), {}, false}, clear_glass());
  p.pov = [text](std::uint32_t) { return text; };
  return p;
}

/// When POV-Ray ends a pixel behind a lens: after `fewest` rays, once it is 80 % sure that the variance is
/// below 1 / `precision`. Of the settings tried, those used here have the least noise for their time.
struct PovBlur {
  std::uint32_t fewest, precision;
};

/// A lens of some width looks at `things`, which POV-Ray's text describes. `times`: the samples of both
/// programs, and POV-Ray's precision, are so many times the usual.
PictureScene through_lens(std::string name, Scene scene, const std::string& things, const PovBlur& blur,
                          std::uint32_t times) {
  PictureScene p;
  p.name = std::move(name);
  p.scene = std::move(scene);
  p.scene.lights = {PointLight{{-20, 40, -20}}};
  p.scene.camera.aperture = 0.4;
  p.pov = [head = p.scene, things, blur, times](std::uint32_t samples) {
    // Variance 0 takes all samples.
    const std::string how = samples == kLong * times
                                ? fmt::format("{} variance 0", samples)
                                : fmt::format("{}, {} variance 1/{} confidence 0.8", blur.fewest * times,
                                              samples, blur.precision * times);
    return pov_head(head, fmt::format("aperture 0.4 focal_point {} blur_samples {}", text_of(head.camera.at),
                                      how)) +
           "light_source { <-20, 40, -20> rgb 1 }\n" + things;
  };
  // At about the same noise.
  p.samples = 64 * times, p.pov_samples = 128 * times;
  p.long_samples = p.pov_long_samples = kLong * times;
  return p;
}

/// Over the field.
PictureScene lens(std::uint32_t width, std::uint32_t height, std::uint32_t times) {
  Scene scene = empty_scene(width, height, {1, 3, -9}, {0, 0.4, 0});
  const std::string things = add_field(scene, 11);
  return through_lens("lens", std::move(scene), things, {4, 4000}, times);
}

/// At three meshes on a floor, one before the focus, one in it and one behind.
PictureScene lens_mesh(std::uint32_t width, std::uint32_t height, std::uint32_t times) {
  Scene scene = empty_scene(width, height, {1, 3, -9}, {0, 0.9, 0});
  std::string things = pov_floor(0);
  const Color colors[] = {{1, 0.5f, 0.3f}, {0.9f, 0.9f, 0.9f}, {0.4f, 0.6f, 1}};
  for (int i = 0; i < 3; ++i) {
    auto mesh = std::make_shared<TriangleMesh>(bench_mesh());
    const Vec3f place{2.2f * static_cast<float>(i - 1), 1, 3.5f * static_cast<float>(i - 1)};
    for (std::size_t k = 0; k < mesh->positions.size(); ++k) mesh->positions[k] += place;
    things += pov_mesh(*mesh) + ' ' + pov_dull(colors[i]) + " }\n";
    add(scene, MeshShape{std::move(mesh), {}, false}, dull(colors[i]));
  }
  add(scene, PlaneShape{}, dull(kFloor));
  return through_lens("lens_mesh", std::move(scene), things, {16, 10000}, times);
}

/// A far lamp of a tenth of its distance, which both programs therefore light alike.
PictureScene lamp(std::uint32_t width, std::uint32_t height) {
  PictureScene p;
  p.name = "lamp";
  p.scene = empty_scene(width, height, {1, 3, -9}, {0, 0.4, 0});
  // One camera ray per pixel in both.
  p.scene.integrator.samples = p.scene.integrator.light_samples = 1;
  const std::string things = add_field(p.scene, 11);
  static constexpr double kEdge = 100, kHigh = 1000;
  Material glow = dull({0, 0, 0});
  const auto radiance = static_cast<float>(std::numbers::pi * kHigh * kHigh / (kEdge * kEdge));
  glow.emission = {radiance, radiance, radiance}, glow.emits_behind = false;
  const double h = kEdge / 2;
  add(p.scene, PolygonShape{{{-h, kHigh, -h}, {h, kHigh, -h}, {h, kHigh, h}, {-h, kHigh, h}}}, glow);
  p.pov = [head = p.scene, things](std::uint32_t samples) {
    const auto side = static_cast<int>(std::lround(std::sqrt(samples)));
    // POV-Ray is several times as fast at the same noise if it takes the corners first. The long run is
    // exact.
    const char* const adaptive = samples == kLong ? "" : "adaptive 0 ";
    return pov_head(head) +
           fmt::format(
               "light_source {{ <0, {}, 0> rgb 1 area_light <{}, 0, 0>, <0, 0, {}>, {}, {} {}jitter "
               "area_illumination on }}\n",
               kHigh, kEdge, kEdge, side, side, adaptive) +
           things;
  };
  // At about the same noise.
  p.samples = 16, p.pov_samples = 25, p.long_samples = p.pov_long_samples = kLong;
  return p;
}

}  // namespace

std::vector<PictureScene> picture_scenes(std::uint32_t width, std::uint32_t height,
                                         std::uint32_t lens_times) {
  return {balls(width, height, 4),   balls(width, height, 5),         glass(width, height),
          glass_mesh(width, height), lens(width, height, lens_times), lens_mesh(width, height, lens_times),
          lamp(width, height)};
}

}  // namespace oktett::bench
