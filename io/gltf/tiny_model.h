#pragma once
/// \file glTF files as tinygltf sees them. Within io/gltf/ only.

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>

#include <string>
#include <vector>

#include "core/error.h"
#include "io/gltf/model.h"

namespace oktett {

inline constexpr const char* kGltfDraco = "KHR_draco_mesh_compression";
inline constexpr const char* kGltfMeshopt = "EXT_meshopt_compression";
inline constexpr const char* kGltfLights = "KHR_lights_punctual";

/// "accessors[3]".
inline std::string gltf_place(const char* list, std::size_t i) {
  return std::string(list) + "[" + std::to_string(i) + "]";
}

/// What tinygltf makes of a file, unchecked, without the buffers and images: those are left to GltfFile. The
/// indices of triangles in Draco's data are the number `indices` of the extension.
struct TinyModel {
  tinygltf::Model model;
  std::vector<GltfSource> buffers, images;
  std::vector<std::string> warnings;
};

/// Throws Error if `json` is no JSON or no glTF.
TinyModel parse_tiny_model(const std::string& path, const std::string& json, bool in_bytes);

/// A colour of three numbers, or of the first three. Throws Error unless they are numbers in [0, most].
Color gltf_color(const std::string& path, const std::string& where, const std::vector<double>& numbers,
                 double most);

/// The material `m`, number `i` of the file; there are so many textures. What is lost is added to
/// `warnings`. Throws Error.
GltfMaterial gltf_material(const std::string& path, const tinygltf::Material& m, std::size_t i,
                           std::size_t textures, std::vector<std::string>& warnings);

}  // namespace oktett
