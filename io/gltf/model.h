#pragma once
/// \file What the JSON of a glTF file says, checked: every index leads to something that is there. Within io/
/// only.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "core/transform.h"
#include "core/vec3.h"

namespace oktett {

/// Types of numbers, by their codes in files.
enum class GltfNumber : std::uint16_t {
  int8 = 5120,
  uint8 = 5121,
  int16 = 5122,
  uint16 = 5123,
  uint32 = 5125,
  float32 = 5126
};

constexpr std::uint32_t bytes_of(GltfNumber number) {
  switch (number) {
    case GltfNumber::int8:
    case GltfNumber::uint8:
      return 1;
    case GltfNumber::int16:
    case GltfNumber::uint16:
      return 2;
    default:
      return 4;
  }
}

/// Bytes of a buffer.
struct GltfRange {
  std::uint32_t buffer = 0;
  std::uint64_t offset = 0, length = 0;
};

/// How EXT_meshopt_compression has packed a view.
struct GltfPacking {
  enum class Mode : std::uint8_t { attributes, triangles, indices };
  enum class Filter : std::uint8_t { none, octahedral, quaternion, exponential };
  GltfRange packed;
  std::uint64_t count = 0;
  std::uint32_t stride = 0;
  Mode mode = Mode::attributes;
  Filter filter = Filter::none;
};

struct GltfView {
  GltfRange range;
  std::uint32_t stride = 0;  ///< bytes from an element to the next; 0: they follow each other
  std::optional<GltfPacking> packing{};
};

/// Elements that stand in other places than the rest of their accessor.
struct GltfSparse {
  std::uint64_t count = 0;
  std::uint32_t index_view = 0, value_view = 0;
  std::uint64_t index_offset = 0, value_offset = 0;
  GltfNumber index_number = GltfNumber::uint32;
};

struct GltfAccessor {
  std::uint32_t view = kNoId;  ///< kNoId: all elements are zero
  std::uint64_t offset = 0, count = 0;
  GltfNumber number = GltfNumber::float32;
  std::uint32_t components = 1;
  bool normalized = false;  ///< whole numbers stand for [0, 1] or [-1, 1]
  std::optional<GltfSparse> sparse{};

  std::uint32_t element_bytes() const { return bytes_of(number) * components; }
};

/// Most sets of texture coordinates of a primitive.
inline constexpr std::size_t kMostGltfUvs = 4;

/// What a vertex has, as an accessor or as a number in Draco's data; kNoId: nothing.
struct GltfAttributes {
  std::uint32_t positions = kNoId, normals = kNoId;
  std::array<std::uint32_t, kMostGltfUvs> uvs{kNoId, kNoId, kNoId, kNoId};
};

struct GltfPrimitive {
  static constexpr int kTriangles = 4, kStrip = 5, kFan = 6;

  int mode = kTriangles;  ///< [0, 6]
  std::uint32_t indices = kNoId, material = kNoId;
  GltfAttributes attributes;
  std::uint32_t draco_view = kNoId;  ///< the view with Draco's data
  GltfAttributes draco_attributes;
};

struct GltfMesh {
  std::string name;
  std::vector<GltfPrimitive> primitives;
};

struct GltfNode {
  std::string name;
  Affine to_parent;
  std::vector<std::uint32_t> children;
  std::uint32_t mesh = kNoId, camera = kNoId, light = kNoId;
};

/// How a material shows a texture.
struct GltfTextureUse {
  std::uint32_t texture = kNoId;
  std::uint32_t uvs = 0;  ///< number of the set of texture coordinates
  Vec2f offset{0, 0}, scale{1, 1};
};

/// Defaults are those of glTF, or leave out what an extension adds.
struct GltfMaterial {
  enum class Alpha : std::uint8_t { opaque, mask, blend };

  std::string name;
  Color base_color{1, 1, 1};
  float alpha = 1, alpha_cutoff = 0.5f;
  Alpha alpha_mode = Alpha::opaque;
  float metallic = 1, roughness = 1;
  Color emission{0, 0, 0};  ///< with its strength
  bool double_sided = false, unlit = false;
  float ior = 1.5f, transmission = 0, thickness = 0, specular = 1;
  float coat = 0, coat_roughness = 0;
  Color sheen_color{0, 0, 0};
  float sheen_roughness = 0;
  GltfTextureUse base_texture, metallic_roughness_texture, normal_texture, emission_texture;
  GltfTextureUse transmission_texture, specular_texture, coat_texture, coat_roughness_texture;
  GltfTextureUse sheen_color_texture, sheen_roughness_texture;
};

struct GltfTexture {
  std::uint32_t image = kNoId;
  bool clamp = false;
};

/// An image or a buffer: in a file, a data URI or a view; a buffer with neither is that of the GLB file.
struct GltfSource {
  std::string uri;                 ///< as it stands in the file
  std::uint32_t data_uri = kNoId;  ///< index into the data URIs of the text
  std::uint32_t view = kNoId;      ///< of an image
  std::uint64_t length = 0;        ///< of a buffer
  bool is_fallback = false;        ///< of a buffer: only for readers without EXT_meshopt_compression
};

struct GltfCamera {
  bool is_perspective = true;
  double yfov = 0.7;  ///< radians
  double aspect = 0;  ///< 0: that of the film
  double ymag = 1;    ///< half of the height
};

struct GltfLight {
  enum class Kind : std::uint8_t { directional, point, spot };
  Kind kind = Kind::point;
  Color color{1, 1, 1};
  double intensity = 1;
  double inner_angle = 0, outer_angle = 0;  ///< radians
};

struct GltfModel {
  std::vector<GltfSource> buffers, images;
  std::vector<GltfView> views;
  std::vector<GltfAccessor> accessors;
  std::vector<GltfMesh> meshes;
  std::vector<GltfNode> nodes;
  std::vector<std::uint32_t> roots;  ///< nodes of the scene that is shown
  std::vector<GltfMaterial> materials;
  std::vector<GltfTexture> textures;
  std::vector<GltfCamera> cameras;
  std::vector<GltfLight> lights;
  std::vector<std::string> warnings;  ///< what is not shown as the file says
};

/// The model that `json` describes, whose data URIs have been taken out (take_out_data); `path` names
/// the file. `in_bytes`: it stands in a GLB file, whose lines say nothing. Throws Error.
GltfModel parse_gltf(const std::string& path, const std::string& json, bool in_bytes);

}  // namespace oktett
