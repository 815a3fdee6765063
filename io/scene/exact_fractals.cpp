/// \file Fractals in scene files.

#include <fmt/format.h>

#include <cmath>

#include "io/scene/exact.h"
#include "io/scene/transform.h"
#include "kernels/fractals/ifs.h"
#include "kernels/fractals/julia.h"
#include "kernels/fractals/terrain.h"

namespace oktett {
namespace {

using MaybeForm = std::optional<ExactForm>;

void read_depth(SceneLoad& load, const YamlNode* node, std::uint32_t& depth, int most) {
  if (node) depth = load.values.integer(*node, 0, static_cast<std::uint32_t>(most));
}

MaybeForm read_sphereflake(SceneLoad& load, const YamlNode&, const YamlNode& node) {
  const Fields fields(node, "sphereflake", {"depth", "ratio"});
  SphereflakeShape shape;
  read_depth(load, fields["depth"], shape.depth, kMaxSphereflakeDepth);
  load.values.read(fields["ratio"], shape.ratio, {0, 0.5, true});
  return shape;
}

MaybeForm read_menger(SceneLoad& load, const YamlNode&, const YamlNode& node) {
  const Fields fields(node, "menger", {"depth"});
  MengerShape shape;
  read_depth(load, fields["depth"], shape.depth, kMaxMengerDepth);
  return shape;
}

Affine read_map(SceneLoad& load, const YamlNode& node) {
  const Affine map = read_transform(load.values, node);
  if (!map.is_invertible()) throw Error(node.where(), "expected a map with an inverse, found a singular one");
  if (const double norm = Ifs::norm(map); !(norm < 1))
    throw Error(
        node.where(),
        fmt::format("expected a contraction, found a map that makes lengths up to {:.6g} times as long",
                    norm));
  return map;
}

MaybeForm read_ifs(SceneLoad& load, const YamlNode&, const YamlNode& node) {
  const Fields fields(node, "ifs", {"maps", "depth", "base", "least", "every_level"});
  IfsShape shape;
  const YamlNode& maps = fields.require("maps");
  const auto items = list_items(maps, "maps");
  if (items.empty() || items.size() > kMaxIfsMaps)
    throw Error(maps.where(), fmt::format("expected 1 to {} maps, found {}", kMaxIfsMaps, items.size()));
  for (const YamlNode* item : items) shape.maps.push_back(read_map(load, *item));
  read_depth(load, fields["depth"], shape.depth, kMaxIfsDepth);
  if (const YamlNode* base = fields["base"])
    shape.base = load.values.choice<IfsShape::Base>(
        *base, {{"ball", IfsShape::Base::ball}, {"box", IfsShape::Base::box}});
  load.values.read(fields["least"], shape.least, {0, 1});
  load.values.read(fields["every_level"], shape.every_level);
  return shape;
}

MaybeForm read_julia(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "julia", {"c", "slice", "iterations", "normals"});
  JuliaShape shape;
  if (const YamlNode* c = fields["c"]) {
    load.values.numbers(*c, shape.c);
    double norm2 = 0;
    for (const double x : shape.c) norm2 += x * x;
    if (norm2 > 4)
      throw Error(c->where(), fmt::format("expected |c| of at most 2, found {:.6g}", std::sqrt(norm2)));
  }
  load.values.read(fields["slice"], shape.slice, kAnyNumber);
  if (const YamlNode* n = fields["iterations"])
    shape.iterations = load.values.integer(*n, 1, static_cast<std::uint32_t>(kMaxJuliaIterations));
  Julia::Pool pool;
  Julia::add(pool, shape, {});
  if (pool.elements.empty()) return skip_exact(load, key, "nothing of the set is in this slice");
  return shape;
}

MaybeForm read_terrain(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "terrain", {"depth", "seed", "height", "roughness", "base"});
  TerrainShape shape;
  read_depth(load, fields["depth"], shape.depth, kMaxTerrainDepth);
  if (const YamlNode* seed = fields["seed"])
    shape.seed = load.values.integer(*seed, 0, std::numeric_limits<std::uint32_t>::max());
  load.values.read(fields["height"], shape.height, kNonNegative);
  load.values.read(fields["roughness"], shape.roughness, {0, 1, false, true});
  load.values.read(fields["base"], shape.base, kAnyNumber);
  Terrain::Pool pool;
  Terrain::add(pool, shape, {});
  if (pool.elements.empty()) return skip_exact(load, key, "the landscape lies below its base");
  return shape;
}

constexpr ExactReader kReaders[] = {{"sphereflake", read_sphereflake},
                                    {"menger", read_menger},
                                    {"ifs", read_ifs},
                                    {"julia", read_julia},
                                    {"terrain", read_terrain}};

}  // namespace

std::span<const ExactReader> fractal_readers() { return kReaders; }

}  // namespace oktett
