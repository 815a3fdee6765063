/// \file Writes a scene of many plants from few models: 61 models of 1.1 million triangles together, 4000
/// plants that show 19.5 million, the sizes of the forest in the slides on instancing.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <string>

#include "bench/plant_models.h"
#include "bench/program.h"
#include "core/random.h"

namespace fs = std::filesystem;

namespace oktett::bench {

namespace {

constexpr std::size_t kModels = 61, kTriangles = 1'100'000, kPlants = 4000, kShown = 19'500'000;
constexpr double kSmallest = 800;  // triangles of the smallest model, about

struct Model {
  std::size_t triangles = 0, plants = 0;
};

/// The x in [lo, hi] with f(x) = value; f must grow.
template <class F>
double solve(double lo, double hi, double value, const F& f) {
  for (int i = 0; i < 100; ++i) {
    const double mid = 0.5 * (lo + hi);
    (f(mid) < value ? lo : hi) = mid;
  }
  return 0.5 * (lo + hi);
}

/// Sizes of the models in geometric progression; smaller models get more plants, so that all sums are right.
std::vector<Model> plan_models() {
  const auto size = [](double ratio, std::size_t i) {
    return kSmallest * std::pow(ratio, static_cast<double>(i));
  };
  const double ratio = solve(1, 2, kTriangles, [&](double r) {
    double sum = 0;
    for (std::size_t i = 0; i < kModels; ++i) sum += size(r, i);
    return sum;
  });
  std::vector<Model> models(kModels);
  for (std::size_t i = 0; i < kModels; ++i)
    models[i].triangles = 2 * static_cast<std::size_t>(std::lround(size(ratio, i) / 2));
  const auto plants = [&](double power, std::size_t i) {
    double sum = 0;
    for (const Model& m : models) sum += std::pow(static_cast<double>(m.triangles), power);
    return kPlants * std::pow(static_cast<double>(models[i].triangles), power) / sum;
  };
  const double power = solve(-2, 1, kShown, [&](double p) {
    double sum = 0;
    for (std::size_t i = 0; i < kModels; ++i) sum += plants(p, i) * static_cast<double>(models[i].triangles);
    return sum;
  });
  double wanted = 0;
  std::size_t given = 0;
  for (std::size_t i = 0; i < kModels; ++i) {
    wanted += plants(power, i);
    models[i].plants = static_cast<std::size_t>(std::lround(wanted)) - given;
    given += models[i].plants;
  }
  return models;
}

PlantKind kind_of(std::size_t model) {
  constexpr PlantKind kSmall[] = {PlantKind::grass, PlantKind::flower, PlantKind::fern};
  if (model < 24) return kSmall[model % 3];
  if (model < 40) return PlantKind::bush;
  return model % 3 == 0 ? PlantKind::conifer : PlantKind::tree;
}

std::string name_of(std::size_t model) { return fmt::format("plant{:02}", model); }

void write_model(const fs::path& dir, std::size_t model, const PlantModel& plant) {
  const bool conifer = kind_of(model) == PlantKind::conifer;
  const std::string materials[] = {"wood", conifer ? "needle" : fmt::format("leaf{}", model % 4),
                                   fmt::format("blossom{}", model % 4)};
  std::string text = "mtllib plants.mtl\n";
  for (const Vec3f& p : plant.vertices) text += fmt::format("v {:.5g} {:.5g} {:.5g}\n", p.x, p.y, p.z);
  for (int part = 0; part < 3; ++part) {
    if (plant.faces[part].empty()) continue;
    text += "usemtl " + materials[part] + "\n";
    for (const auto& f : plant.faces[part]) text += fmt::format("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
  }
  write_text((dir / (name_of(model) + ".obj")).string(), text);
}

constexpr const char* kMaterials =
    "newmtl wood\nKd 0.30 0.22 0.15\n"
    "newmtl needle\nKd 0.09 0.20 0.11\n"
    "newmtl leaf0\nKd 0.21 0.42 0.10\n"
    "newmtl leaf1\nKd 0.30 0.47 0.13\n"
    "newmtl leaf2\nKd 0.15 0.36 0.12\n"
    "newmtl leaf3\nKd 0.38 0.48 0.16\n"
    "newmtl blossom0\nKd 0.85 0.75 0.20\n"
    "newmtl blossom1\nKd 0.80 0.25 0.30\n"
    "newmtl blossom2\nKd 0.90 0.88 0.85\n"
    "newmtl blossom3\nKd 0.55 0.35 0.75\n";

constexpr const char* kHead =
    "# 4000 plants of 61 models; `plants` has written this.\n"
    "oktett: 1\n"
    "camera: {from: [0, 3.2, 27], at: [0, 1.6, 0], fov: 34}\n"
    "film: {width: 1280, height: 640}\n"
    "integrator: {samples: 16}\n"
    "background: [0.55, 0.70, 0.88]\n"
    "ambient_light: [0.75, 0.85, 1]\n"
    "lights:\n"
    "  - directional: {direction: [-0.5, -0.8, -0.35], color: [1, 0.95, 0.85]}\n"
    "materials:\n"
    "  soil: {color: [0.33, 0.30, 0.18], ambient: 0.2, diffuse: 0.8}\n";

/// The plants on a meadow, the larger ones farther from the camera.
std::string scatter(const std::vector<Model>& models) {
  std::string text = "objects:\n  - {plane: , material: soil}\n";
  std::uint32_t count = 0;
  const std::uint64_t key = mix_bits(17);
  for (std::size_t i = 0; i < models.size(); ++i) {
    const bool tall = i >= 40;
    for (std::size_t k = 0; k < models[i].plants; ++k) {
      const auto random = [&] { return static_cast<double>(random_float(key, 0, count++)); };
      // As wide as what the camera sees at that distance.
      const double near = tall ? 14 : 3,
                   depth = near + (tall ? 50 : 34) * (tall ? random() : std::pow(random(), 1.3));
      const double x = (2 * random() - 1) * (3 + 0.65 * depth), size = 0.8 + 0.4 * random();
      text += fmt::format(
          "  - {{instance: {}, transform: [{{scale: [{:.3f}, {:.3f}, {:.3f}]}}, {{rotate: [0, {:.1f}, 0]}}, "
          "{{translate: [{:.3f}, 0, {:.3f}]}}]}}\n",
          name_of(i), size, size * (0.9 + 0.2 * random()), size, 360 * random(), x, 27 - depth);
    }
  }
  return text;
}

int run(int argc, char** argv) {
  if (argc != 2 || argv[1][0] == '-') {
    std::fprintf(stderr, "usage: plants DIRECTORY\nWrites plants.yaml and its models there.\n");
    return 2;
  }
  const fs::path dir = argv[1];
  fs::create_directories(dir);
  const std::vector<Model> models = plan_models();
  std::string scene = std::string(kHead) + "define:\n";
  std::size_t unique = 0, plants = 0, shown = 0;
  for (std::size_t i = 0; i < models.size(); ++i) {
    const PlantModel plant = make_plant(kind_of(i), models[i].triangles, static_cast<std::uint32_t>(i));
    write_model(dir, i, plant);
    scene += fmt::format("  {0}: {{mesh: {{file: {0}.obj, smooth: false}}}}\n", name_of(i));
    unique += plant.triangles(), plants += models[i].plants, shown += plant.triangles() * models[i].plants;
  }
  write_text((dir / "plants.mtl").string(), kMaterials);
  write_text((dir / "plants.yaml").string(), scene + scatter(models));
  fmt::print("{} models, {} triangles; {} plants that show {}\n", models.size(), unique, plants, shown);
  return 0;
}

}  // namespace

}  // namespace oktett::bench

int main(int argc, char** argv) { return oktett::bench::run_program(oktett::bench::run, argc, argv); }
