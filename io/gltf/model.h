#pragma once
/// \file What the JSON of a glTF file says, checked: every index leads to something that is there. Within io/
/// only.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh.h"
#include "core/transform.h"
#include "core/vec3.h"
#include "render/material.h"

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
  bool is_matrix = false;
  std::string problem{};    ///< why its elements cannot be read; empty: they can
  bool normalized = false;  ///< whole numbers stand for [0, 1] or [-1, 1]
  std::optional<GltfSparse> sparse{};

  std::uint32_t element_bytes() const { return bytes_of(number) * components; }
};

/// What vertices carry as an attribute of their mesh.
struct GltfCarried {
  std::string name;          ///< in the mesh: "color" for COLOR_0, "color_1" for COLOR_1, "NAME" for _NAME
  std::uint32_t number = 0;  ///< as those of GltfAttributes
  bool is_color = false;     ///< of COLOR_n
};

/// What a vertex has, as an accessor or as a number in Draco's data; kNoId: nothing.
struct GltfAttributes {
  std::uint32_t positions = kNoId, normals = kNoId, tangents = kNoId;
  /// Four joints of a skin and their weights in each.
  std::vector<std::uint32_t> joints, weights;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> uvs;  ///< sets of texture coordinates by their numbers
  std::vector<GltfCarried> carried;                          ///< of different names; none of morph targets

  std::uint32_t uv_set(std::uint32_t number) const {
    for (const auto& [set, accessor] : uvs)
      if (set == number) return accessor;
    return kNoId;
  }
};

struct GltfPrimitive {
  static constexpr int kPoints = 0, kLines = 1, kLineLoop = 2;  // 3: a strip of lines
  static constexpr int kTriangles = 4, kStrip = 5, kFan = 6;

  int mode = kTriangles;  ///< [0, 6]; 7: of none of these
  std::uint32_t indices = kNoId, material = kNoId;
  GltfAttributes attributes;
  std::uint32_t draco_view = kNoId;  ///< the view with Draco's data
  GltfAttributes draco_attributes;
  std::vector<GltfAttributes> targets;              ///< what morph targets add
  std::map<std::uint32_t, std::uint32_t> variants;  ///< materials by the numbers of variants

  bool has_strokes() const { return mode < kTriangles; }
};

struct GltfMesh {
  std::string name;
  std::vector<GltfPrimitive> primitives;
  std::vector<double> weights;  ///< of morph targets; may be shorter than their list
};

/// The transform of a node in parts, which animations change one by one.
struct GltfPlace {
  Vec3d translation{0, 0, 0}, scale{1, 1, 1};
  std::array<double, 4> rotation{0, 0, 0, 1};  ///< a quaternion x, y, z, w of any length but zero

  Affine transform() const;
};

struct GltfNode {
  std::string name;
  Affine to_parent;
  GltfPlace place;  ///< as `to_parent`, unless that is a matrix of the file
  std::vector<std::uint32_t> children;
  std::uint32_t mesh = kNoId, camera = kNoId, light = kNoId, skin = kNoId;
  std::vector<double> weights;  ///< instead of those of the mesh
  /// Accessors of EXT_mesh_gpu_instancing; kNoId: none.
  std::uint32_t instance_translations = kNoId, instance_rotations = kNoId, instance_scales = kNoId;
  bool is_instanced = false;
  bool has_matrix = false;  ///< its transform is not in parts
};

struct GltfSkin {
  std::vector<std::uint32_t> joints;  ///< nodes
  std::uint32_t inverse_binds = kNoId;
};

/// What an animation changes.
struct GltfChannel {
  enum class Path : std::uint8_t { translation, rotation, scale, weights };
  enum class Curve : std::uint8_t { linear, step, cubic };
  std::uint32_t node = 0;
  Path path = Path::translation;
  Curve curve = Curve::linear;
  std::uint32_t times = 0, values = 0;  ///< accessors
};

/// How a material shows a texture.
struct GltfTextureUse {
  std::uint32_t texture = kNoId;
  std::uint32_t uvs = 0;  ///< number of the set of texture coordinates
  Vec2f offset{0, 0}, scale{1, 1};
  double rotation = 0;  ///< radians, counter-clockwise in an image
  bool operator==(const GltfTextureUse&) const = default;
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
  float normal_scale = 1;
  bool double_sided = false, unlit = false;
  float ior = 1.5f, transmission = 0, thickness = 0, specular = 1;
  Color specular_color{1, 1, 1};
  Color attenuation{1, 1, 1};       ///< what is left of white light within
  double attenuation_distance = 0;  ///< after this way; 0: nothing is absorbed
  float anisotropy = 0;
  double anisotropy_rotation = 0;  ///< radians
  float iridescence = 0, iridescence_ior = 1.3f, least_thickness = 100, most_thickness = 400;
  float dispersion = 0;
  float coat = 0, coat_roughness = 0, coat_normal_scale = 1;
  Color sheen_color{0, 0, 0};
  float sheen_roughness = 0;
  bool is_glossy = false;  ///< roughness is 1 minus gloss times the alpha of `gloss_texture`
  float gloss = 1;
  GltfTextureUse gloss_texture;
  GltfTextureUse base_texture, metallic_roughness_texture, normal_texture, emission_texture;
  GltfTextureUse transmission_texture, specular_texture, coat_texture, coat_roughness_texture;
  GltfTextureUse specular_color_texture, coat_normal_texture, anisotropy_texture;
  GltfTextureUse iridescence_texture, thickness_texture;
  GltfTextureUse sheen_color_texture, sheen_roughness_texture;
};

/// Calls f(use) for all textures that a material shows, the most important first.
template <class F>
void for_each_texture_use(const GltfMaterial& m, const F& f) {
  for (const GltfTextureUse* use :
       {&m.base_texture, &m.metallic_roughness_texture, &m.gloss_texture, &m.normal_texture,
        &m.emission_texture, &m.transmission_texture, &m.coat_texture, &m.specular_texture,
        &m.specular_color_texture, &m.coat_roughness_texture, &m.coat_normal_texture, &m.sheen_color_texture,
        &m.sheen_roughness_texture, &m.anisotropy_texture, &m.iridescence_texture, &m.thickness_texture})
    if (use->texture != kNoId) f(*use);
}

/// Whether what a material shows depends on the tangents of meshes.
inline bool has_tangents(const GltfMaterial& m) {
  return m.normal_texture.texture != kNoId || m.coat_normal_texture.texture != kNoId || m.anisotropy > 0;
}

/// The sets of texture coordinates by which a material shows textures; kNoId: there is no such one. A mesh
/// has two.
struct UvSets {
  std::uint32_t first = kNoId, second = kNoId;
};
inline UvSets gltf_uv_sets(const GltfMaterial& m) {
  UvSets sets;
  for_each_texture_use(m, [&](const GltfTextureUse& use) {
    if (sets.first == kNoId)
      sets.first = use.uvs;
    else if (use.uvs != sets.first && sets.second == kNoId)
      sets.second = use.uvs;
  });
  return sets;
}

struct GltfTexture {
  std::uint32_t image = kNoId;
  TextureLookup lookup;
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
  std::string problem{};  ///< why a picture cannot show what it sees; empty: it can
  double yfov = 0.7;      ///< radians
  double aspect = 0;      ///< 0: that of the film
  double ymag = 1;        ///< half of the height
};

struct GltfLight {
  enum class Kind : std::uint8_t { directional, point, spot, unknown };
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
  std::vector<GltfSkin> skins;
  std::vector<GltfChannel> channels;  ///< of all animations; the first one of a node's property counts
  std::vector<std::string> variants;  ///< their names
  std::vector<std::string> warnings;  ///< what is not shown as the file says
};

/// The model that `json` describes, whose data URIs have been taken out (take_out_data); `path` names
/// the file. `in_bytes`: it stands in a GLB file, whose lines say nothing. Throws Error.
GltfModel parse_gltf(const std::string& path, const std::string& json, bool in_bytes);

}  // namespace oktett
