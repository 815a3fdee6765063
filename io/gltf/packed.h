#pragma once
/// \file What libraries have packed: meshes by Draco (KHR_draco_mesh_compression), views by meshoptimizer
/// (EXT_meshopt_compression). Within io/ only.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/gltf/gltf_file.h"

namespace oktett {

/// Whether the program is built with Draco's library.
bool can_unpack_draco();

/// What Draco's data hold: three indices for each triangle, and the numbers of each vertex one after the
/// other.
struct DracoMesh {
  std::uint64_t vertices = 0;
  std::vector<std::uint32_t> indices;
  std::vector<float> positions, normals, uvs;  ///< normals and uvs are empty unless asked for
};

/// Unpacks the attributes, which `wanted` gives by their numbers in the data, with one set of texture
/// coordinates. Throws Error, which begins with `where`, for damaged data.
DracoMesh unpack_draco(const GltfFile& file, std::string_view bytes, const GltfAttributes& wanted,
                       std::size_t uv_set, const std::string& where);

/// Unpacks a view. Throws Error if its bytes are damaged, or if the program is built without meshoptimizer.
std::string unpack_meshopt(const GltfFile& file, const GltfPacking& packing, const std::string& where);

}  // namespace oktett
