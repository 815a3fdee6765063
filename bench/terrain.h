#pragma once
/// \file Terrain for benchmarks: noise of many octaves, the same on every machine.

#include <cstdint>

#include "core/mesh.h"
#include "core/soa.h"

namespace oktett::bench {

/// n x n heights from 0 to 65535, row by row. The hills are the same for every n.
Column<std::uint16_t> terrain(std::uint32_t n);

/// 2 (n - 1)^2 triangles over the square of x and z from -1 to 1, their heights times `height`, split as
/// HeightInterpolation::triangles is.
TriangleMesh terrain_mesh(const Column<std::uint16_t>& heights, std::uint32_t n, double height);

}  // namespace oktett::bench
