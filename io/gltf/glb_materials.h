#pragma once
/// \file Materials as glTF says them. Within io/gltf/ only.

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "io/gltf/tiny_model.h"
#include "io/mesh/mesh_file.h"
#include "io/mesh/mesh_output.h"

namespace oktett {

/// Appends bytes to the only buffer of a model; the index of their view. `target`: 0 for none.
int add_gltf_view(tinygltf::Model& model, const void* bytes, std::size_t size, int target);

/// Adds materials to a model, and their images to its only buffer.
class GltfMaterialWriter {
 public:
  GltfMaterialWriter(tinygltf::Model& model, const MeshFile& file) : model_(model), file_(file) {}

  /// The index in the model of the material of a slot; -1 for one like that of triangles without a material.
  int add(std::size_t slot);
  /// Adds textures that glTF cannot show to `losses`.
  void note_losses(MeshLosses& losses) const;

 private:
  void set_base(const Material& m, tinygltf::Material& out);
  void set_emission(const Material& m, tinygltf::Material& out);
  void set_opacity(const Material& m, float opacity, tinygltf::Material& out);
  void set_drawn_opacity(const Material& m, tinygltf::Material& out);
  void set_normals(const Material& m, std::size_t slot, tinygltf::Material& out);
  void set_metal(const PrincipledMaterial& p, tinygltf::Material& out);
  void set_glass(const PrincipledMaterial& p, std::uint32_t interior, tinygltf::Material& out);
  void set_specular(const PrincipledMaterial& p, tinygltf::Material& out);
  void set_anisotropy(const PrincipledMaterial& p, tinygltf::Material& out);
  void set_iridescence(const PrincipledMaterial& p, tinygltf::Material& out);
  void set_layers(const PrincipledMaterial& p, tinygltf::Material& out);

  bool is_plain(std::uint32_t texture, ImageChannel channel) const;
  int texture(std::uint32_t index);
  int texture_of(const Texture& texture);
  int sampler(TextureLookup lookup);
  int image(const Texture& texture);
  int add_image(const std::string& key, const std::string& bytes);
  int add_texture(const Texture& texture, int image);
  void place(const Texture& texture, int& set, tinygltf::ExtensionMap& extensions);
  tinygltf::Value::Object info(std::uint32_t index);
  template <class Info>
  static tinygltf::Value::Object object_of(const Info& info);
  template <class Info>
  void set(std::uint32_t index, Info& info);
  void extend(tinygltf::Material& out, const char* name, tinygltf::Value::Object values);

  tinygltf::Model& model_;
  const MeshFile& file_;
  std::set<std::uint32_t> written_;
  std::map<std::string, int> images_;  ///< by path or what they are made of; -1 for those that cannot be
  std::size_t bumps_ = 0, drawn_ = 0;  ///< how many images were computed
};

}  // namespace oktett
