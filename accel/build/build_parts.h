#pragma once
/// \file Trees over more triangles than are built at once. The references are divided among parts of space,
/// by the surface-area cost over the cells of a grid; each part gets a tree of its own, and a small tree
/// stands over all parts. So a build takes the memory of one part beside the tree, in place of that of all.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "accel/build/mesh_source.h"

namespace oktett {

/// The most memory, in bytes, that the tree over so many triangles takes while it is built, beside the
/// meshes.
std::uint64_t build_bytes(std::size_t triangles, const BuildOptions& options);

/// Throws Error, with what it would take, if that is more than `available` bytes.
void expect_memory(std::size_t triangles, const BuildOptions& options, std::uint64_t available);

/// Does what build_tree does, for the triangles of the geometries `meshes` and for `others`, which it uses
/// up. Grows accel.bounds too. Parts have at most half of BuildOptions::together references where possible.
/// The same tree for any number of threads.
void build_in_parts(Accel& accel, const MeshSource& source, const std::vector<std::uint32_t>& meshes,
                    Column<PrimRef>& others, ItemOrder& order, const BuildOptions& options,
                    const BuildKernels& kernels);

}  // namespace oktett
