#pragma once
/// \file Plants made by rule: stems that branch, and leaves until a given number of triangles is reached.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/vec3.h"

namespace oktett::bench {

enum class PlantKind { grass, flower, fern, bush, conifer, tree };

/// What a triangle belongs to, in the order of PlantModel::faces.
enum class PlantPart { wood, leaf, blossom };

/// A plant that stands on the plane y = 0 at the origin.
struct PlantModel {
  std::vector<Vec3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> faces[3];  ///< by PlantPart

  std::size_t triangles() const { return faces[0].size() + faces[1].size() + faces[2].size(); }
};

/// A plant of exactly `triangles` triangles, an even number of at least 200. A function of its arguments
/// alone.
PlantModel make_plant(PlantKind kind, std::size_t triangles, std::uint32_t seed);

}  // namespace oktett::bench
