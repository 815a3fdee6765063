/// \file Writes the meadow of many plants from few models as a scene file and OBJ files.

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <string>

#include "bench/meadow.h"
#include "bench/program.h"

namespace fs = std::filesystem;

namespace oktett::bench {

namespace {

std::string name_of(std::size_t model) { return fmt::format("plant{:02}", model); }

void write_model(const fs::path& dir, std::size_t model, const Meadow& meadow) {
  const PlantModel& plant = meadow.models[model];
  const bool conifer = meadow.kinds[model] == PlantKind::conifer;
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

/// The objects of the scene.
std::string objects(const Meadow& meadow) {
  std::string text = "objects:\n  - {plane: , material: soil}\n";
  for (const Meadow::Plant& p : meadow.plants)
    text += fmt::format(
        "  - {{instance: {}, transform: [{{scale: [{:.3f}, {:.3f}, {:.3f}]}}, {{rotate: [0, {:.1f}, 0]}}, "
        "{{translate: [{:.3f}, 0, {:.3f}]}}]}}\n",
        name_of(p.model), p.scale.x, p.scale.y, p.scale.z, p.degrees, p.position.x, p.position.z);
  return text;
}

int run(int argc, char** argv) {
  if (argc != 2 || argv[1][0] == '-') {
    std::fprintf(stderr, "usage: plants DIRECTORY\nWrites plants.yaml and its models there.\n");
    return 2;
  }
  const fs::path dir = argv[1];
  fs::create_directories(dir);
  const Meadow meadow = make_meadow();
  std::string scene = std::string(kHead) + "define:\n";
  std::size_t unique = 0, shown = 0;
  for (std::size_t i = 0; i < meadow.models.size(); ++i) {
    write_model(dir, i, meadow);
    scene += fmt::format("  {0}: {{mesh: {{file: {0}.obj, smooth: false}}}}\n", name_of(i));
    unique += meadow.models[i].triangles();
  }
  for (const Meadow::Plant& p : meadow.plants) shown += meadow.models[p.model].triangles();
  write_text((dir / "plants.mtl").string(), kMaterials);
  write_text((dir / "plants.yaml").string(), scene + objects(meadow));
  fmt::print("{} models, {} triangles; {} plants that show {}\n", meadow.models.size(), unique,
             meadow.plants.size(), shown);
  return 0;
}

}  // namespace

}  // namespace oktett::bench

int main(int argc, char** argv) { return oktett::bench::run_program(oktett::bench::run, argc, argv); }
