#pragma once
/// \file Values of a JSON text that check_gltf_types has seen: all have their types. Within io/gltf/ only.

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/gltf/gltf_file.h"

namespace oktett {

inline constexpr const char* kGltfDraco = "KHR_draco_mesh_compression";
inline constexpr const char* kGltfMeshopt = "EXT_meshopt_compression";
inline constexpr const char* kGltfLights = "KHR_lights_punctual";
inline constexpr const char* kGltfVariants = "KHR_materials_variants";
inline constexpr const char* kGltfInstances = "EXT_mesh_gpu_instancing";

using GltfJson = nlohmann::json;

/// "accessors[3]".
inline std::string gltf_place(const char* list, std::size_t i) {
  return std::string(list) + "[" + std::to_string(i) + "]";
}

/// A member, or null if there is none.
inline const GltfJson* member(const GltfJson& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}
/// An extension of an object, or null.
inline const GltfJson* extension_of(const GltfJson& object, const char* name) {
  const GltfJson* const extensions = member(object, "extensions");
  return extensions == nullptr ? nullptr : member(*extensions, name);
}
/// The members of a list, which may be missing.
inline const GltfJson& list_of(const GltfJson& object, const char* key) {
  static const GltfJson nothing = GltfJson::array();
  const GltfJson* const list = member(object, key);
  return list == nullptr ? nothing : *list;
}
inline std::string text_of(const GltfJson& object, const char* key, const char* standard = "") {
  const GltfJson* const value = member(object, key);
  return value == nullptr ? standard : value->get<std::string>();
}
inline double number_of(const GltfJson& object, const char* key, double standard) {
  const GltfJson* const value = member(object, key);
  return value == nullptr ? standard : value->get<double>();
}
inline bool flag_of(const GltfJson& object, const char* key) {
  const GltfJson* const value = member(object, key);
  return value != nullptr && value->get<bool>();
}
inline std::uint64_t whole_of(const GltfJson& object, const char* key, std::uint64_t standard) {
  const GltfJson* const value = member(object, key);
  return value == nullptr ? standard : value->get<std::uint64_t>();
}
inline std::vector<double> numbers_of(const GltfJson& object, const char* key) {
  const GltfJson* const value = member(object, key);
  return value == nullptr ? std::vector<double>{} : value->get<std::vector<double>>();
}

/// The number of something at `key`, kNoId if there is none. Throws Error, which begins with `where`, unless
/// it is below `count`, that of the things called `what`.
std::uint32_t index_of(const std::string& path, const GltfJson& object, const char* key, std::size_t count,
                       const std::string& where, const char* what);
/// The same for a number by itself.
std::uint32_t checked_index(const std::string& path, std::uint64_t index, std::size_t count,
                            const std::string& where, const char* what);

/// A colour of three numbers, or of the first three. Throws Error unless they are numbers in [0, most].
Color gltf_color(const std::string& path, const std::string& where, const std::vector<double>& numbers,
                 double most);

/// The material `m`, number `i` of the file; there are so many textures. What is lost is added to
/// `warnings`. Throws Error.
GltfMaterial gltf_material(const std::string& path, const GltfJson& m, std::size_t i, std::size_t textures,
                           std::vector<std::string>& warnings);

/// The model of a file whose types have been checked. Throws Error.
GltfModel gltf_model(const std::string& path, const GltfJson& root);

}  // namespace oktett
