#pragma once
/// \file What libraries have packed: meshes by Draco (KHR_draco_mesh_compression), views by meshoptimizer
/// (EXT_meshopt_compression). Within io/ only.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/gltf/gltf_file.h"

namespace oktett {

/// Whether the program is built with Draco's library.
bool can_unpack_draco();

/// How many numbers a vertex has of each attribute that is read: positions, normals, texture coordinates,
/// tangents, further texture coordinates.
inline constexpr std::array<std::size_t, 5> kDracoSizes{3, 3, 2, 4, 2};

/// What Draco's data hold: three indices for each triangle, and for each attribute the numbers of each vertex
/// one after the other, none unless asked for.
struct DracoMesh {
  std::uint64_t vertices = 0;
  std::vector<std::uint32_t> indices;
  std::array<std::vector<float>, kDracoSizes.size()> numbers;
  /// What the mesh carries besides, of any type.
  struct Carried {
    GltfNumber number = GltfNumber::float32;
    std::uint32_t components = 1;
    bool normalized = false;  ///< say the data
    std::string bytes{};      ///< without gaps
  };
  std::vector<Carried> carried;                     ///< as they were asked for
  std::vector<std::vector<float>> joints, weights;  ///< four of each vertex, by set
};

/// Unpacks the attributes that `wanted` gives by their numbers in the data, kNoId: not wanted, and of
/// `others` what is carried, joints and weights. Whole numbers of what is `normalized` are parts of the
/// greatest one. Throws Error, which begins with `where`, for damaged data.
DracoMesh unpack_draco(const GltfFile& file, std::string_view bytes,
                       const std::array<std::uint32_t, kDracoSizes.size()>& wanted,
                       const std::array<bool, kDracoSizes.size()>& normalized, const GltfAttributes& others,
                       const std::string& where);

/// Unpacks a view. Throws Error if its bytes are damaged, or if the program is built without meshoptimizer.
std::string unpack_meshopt(const GltfFile& file, const GltfPacking& packing, const std::string& where);

}  // namespace oktett
