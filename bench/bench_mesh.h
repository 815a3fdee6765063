#pragma once
/// \file The mesh that benchmarks trace: the file named by OKTETT_BENCH_MESH, or a generated one.

#include "core/mesh.h"

namespace oktett::bench {

/// Read or made once per program. The generated one is a sphere with waves on it.
const TriangleMesh& bench_mesh();

}  // namespace oktett::bench
