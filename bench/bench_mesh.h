#pragma once
/// \file The mesh that benchmarks trace: the file named by OKTETT_BENCH_MESH, or a generated one.

#include "core/mesh.h"

namespace oktett::bench {

/// A sphere with waves on it, of 2 * n * n triangles; deterministic.
TriangleMesh wavy_sphere(std::uint32_t n);

/// Read or made once per program.
const TriangleMesh& bench_mesh();

}  // namespace oktett::bench
