#include "io/gltf/glb_materials.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "accel/accel.h"
#include "core/error.h"
#include "core/math.h"
#include "core/mesh_geometry.h"
#include "io/gltf/glb_images.h"
#include "io/gltf/gltf_file.h"
#include "io/text/file_content.h"
#include "render/material.h"

namespace oktett {

namespace {

using tinygltf::Value;

/// From here on an opacity goes from nothing to all within less than three steps of 8 bits.
constexpr float kHardGain = 100;

double unit(float x) { return std::clamp(static_cast<double>(x), 0.0, 1.0); }

Value::Array numbers(const Color& c) {
  return {Value(static_cast<double>(c.x)), Value(static_cast<double>(c.y)), Value(static_cast<double>(c.z))};
}

std::string_view mime_type(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n")) return "image/png";
  return bytes.starts_with("\xff\xd8\xff") ? "image/jpeg" : "";
}

/// The transform of texture coordinates, whose v points down in glTF.
Value::Object transform_of(const Texture& t) {
  const double scale = t.scale.y, c = std::cos(double{t.rotation}), s = std::sin(double{t.rotation});
  Value::Object made{
      {"offset", Value(Value::Array{Value(t.offset.x - s * scale), Value(1 - c * scale - t.offset.y)})},
      {"scale", Value(Value::Array{Value(double{t.scale.x}), Value(scale)})}};
  if (t.rotation != 0) made.emplace("rotation", Value(double{t.rotation}));
  return made;
}

/// Whether both lie on surfaces in the same way.
bool is_laid_alike(const Texture& a, const Texture& b) {
  return a.scale == b.scale && a.offset == b.offset && a.rotation == b.rotation && a.lookup == b.lookup &&
         a.uv_layer == b.uv_layer;
}

/// How long u and v from 0 to 1 are on the triangles of a slot, on average over their area.
Vec2f uv_lengths(const TriangleMesh& mesh, std::size_t slot) {
  double u = 0, v = 0, whole = 0;
  for (std::uint32_t i = 0; i < mesh.triangle_count(); ++i) {
    if (!mesh.material_slots.empty() && mesh.material_slots[i] != slot) continue;
    Vec3f corners[3], by_u{0, 0, 0}, by_v{0, 0, 0};
    for (std::size_t k = 0; k < 3; ++k) corners[k] = mesh.positions[mesh.indices[3 * std::size_t{i} + k]];
    set_uv_tangents(corner_uvs(mesh, i), corners, by_u, by_v);
    const double area = length(area_normal(mesh, i)), us = length(Vec3d(by_u)), vs = length(Vec3d(by_v));
    if (!(us > 0 && vs > 0 && std::isfinite(us * vs * area))) continue;
    u += us * area, v += vs * area, whole += area;
  }
  if (!(whole > 0)) return {0, 0};
  return {static_cast<float>(u / whole), static_cast<float>(v / whole)};
}

bool is_moved(const Texture& t) {
  return t.scale.x != 1 || t.scale.y != 1 || t.offset.x != 0 || t.offset.y != 0 || t.rotation != 0;
}

}  // namespace

int add_gltf_view(tinygltf::Model& model, const void* bytes, std::size_t size, int target) {
  std::vector<unsigned char>& data = model.buffers[0].data;
  data.resize((data.size() + 3) / 4 * 4);
  tinygltf::BufferView view;
  view.buffer = 0, view.byteOffset = data.size(), view.byteLength = size, view.target = target;
  const auto* first = static_cast<const unsigned char*>(bytes);
  data.insert(data.end(), first, first + size);
  model.bufferViews.push_back(view);
  return static_cast<int>(model.bufferViews.size()) - 1;
}

int GltfMaterialWriter::add(std::size_t slot) {
  const Material& m = file_.materials[slot];
  if (m == Material{}) return -1;
  tinygltf::Material out;
  out.name = m.name;
  out.doubleSided = m.emits_behind;
  PrincipledMaterial p = m.principled ? *m.principled : principled_like(m);
  // What is there in part and lets the rest of the light pass, as by `d` of MTL, is blended in glTF.
  float opacity = m.opacity;
  if (!m.principled && m.transparency < 1) {
    opacity *= 1 - m.transparency;
    p.parameters.transmission = 0;
    // Light that is let pass straight has no index of refraction; plastic does.
    if (m.ior == 1) p.parameters.ior = PrincipledParameters{}.ior;
  }
  set_base(m, out);
  set_emission(m, out);
  set_opacity(m, opacity, out);
  set_metal(p, out);
  set_glass(p, m.interior, out);
  set_normals(m, slot, out);
  set_layers(p, out);
  set_anisotropy(p, out);
  set_iridescence(p, out);
  model_.materials.push_back(std::move(out));
  return static_cast<int>(model_.materials.size()) - 1;
}

void GltfMaterialWriter::set_base(const Material& m, tinygltf::Material& out) {
  out.pbrMetallicRoughness.baseColorFactor = {unit(m.color.x), unit(m.color.y), unit(m.color.z), 1};
  set(m.color_texture, out.pbrMetallicRoughness.baseColorTexture);
}

void GltfMaterialWriter::set_emission(const Material& m, tinygltf::Material& out) {
  const float most = std::max(1.0f, max_component(m.emission));
  const Color factor = most > 1 ? m.emission * (1 / most) : m.emission;
  out.emissiveFactor = {unit(factor.x), unit(factor.y), unit(factor.z)};
  if (most > 1)
    extend(out, "KHR_materials_emissive_strength", {{"emissiveStrength", Value(static_cast<double>(most))}});
  set(m.emission_texture, out.emissiveTexture);
}

void GltfMaterialWriter::set_opacity(const Material& m, float opacity, tinygltf::Material& out) {
  double& alpha = out.pbrMetallicRoughness.baseColorFactor[3];
  alpha = unit(opacity);
  if (opacity < 1 || m.tint_opacity_texture != kNoId) out.alphaMode = "BLEND";
  if (m.opacity_texture == kNoId) return;
  // glTF has one image for colour and opacity.
  const Texture& t = file_.textures[m.opacity_texture];
  const Texture* const color = m.color_texture == kNoId ? nullptr : &file_.textures[m.color_texture];
  const bool shares_image = color != nullptr && t.channel == ImageChannel::alpha && t.path == color->path &&
                            t.content == color->content && written_.contains(m.color_texture);
  const bool shares_colors =
      m.color_texture == kNoId && t.channel == ImageChannel::alpha && t.attribute == kColorAttribute;
  if (shares_image && t.gain == 1 && t.base == 0) {
    out.alphaMode = "BLEND";
  } else if ((shares_image || shares_colors) && t.gain >= kHardGain && t.gain <= kGltfMaskSlope) {
    out.alphaMode = "MASK";
    alpha = static_cast<double>(t.gain / kGltfMaskSlope);
    out.alphaCutoff = std::max(0.0, static_cast<double>((kGltfMaskAtCutoff - t.base) / kGltfMaskSlope));
  } else {
    return set_drawn_opacity(m, out);
  }
  written_.insert(m.opacity_texture);
}

/// Draws an image of both colour and opacity.
void GltfMaterialWriter::set_drawn_opacity(const Material& m, tinygltf::Material& out) {
  const Texture& opacity = file_.textures[m.opacity_texture];
  const Texture* color = m.color_texture == kNoId ? nullptr : &file_.textures[m.color_texture];
  if (opacity.pattern || !opacity.attribute.empty() ||
      (color != nullptr && !written_.contains(m.color_texture)))
    return;
  if (color != nullptr && !is_laid_alike(*color, opacity)) return;
  const std::string key =
      "opacity:" + std::to_string(m.color_texture) + ":" + std::to_string(m.opacity_texture);
  const auto known = images_.find(key);
  int image = known == images_.end() ? -1 : known->second;
  try {
    if (known == images_.end()) image = add_image(key, png_of_texture(color, &opacity));
  } catch (const Error&) {
    images_[key] = -1;
    return;
  }
  if (image < 0) return;
  tinygltf::TextureInfo& info = out.pbrMetallicRoughness.baseColorTexture;
  info = {};
  info.index = add_texture(opacity, image);
  place(opacity, info.texCoord, info.extensions);
  out.alphaMode = "BLEND";
  written_.insert(m.opacity_texture);
  ++drawn_;
}

/// Normal maps as they are, bumps as the normals of their heights.
void GltfMaterialWriter::set_normals(const Material& m, std::size_t slot, tinygltf::Material& out) {
  set(m.normal_texture, out.normalTexture);
  out.normalTexture.scale = double{m.normal_scale};
  if (m.normal_texture != kNoId || m.bump_texture == kNoId) return;
  const Texture& bump = file_.textures[m.bump_texture];
  if (bump.pattern || !bump.attribute.empty() || bump.scale.x == 0 || bump.scale.y == 0) return;
  const Vec2f size = uv_lengths(file_.mesh, slot);
  const double width = double{size.x} / std::abs(double{bump.scale.x}),
               height = double{size.y} / std::abs(double{bump.scale.y});
  if (!(width > 0 && height > 0 && std::isfinite(width) && std::isfinite(height))) return;
  try {
    const int image = add_image("bump:" + std::to_string(m.bump_texture) + ":" + std::to_string(slot),
                                png_of_heights(bump, double{m.bump_scale}, width, height));
    out.normalTexture.index = add_texture(bump, image);
  } catch (const Error&) {
    return;
  }
  place(bump, out.normalTexture.texCoord, out.normalTexture.extensions);
  written_.insert(m.bump_texture);
  ++bumps_;
}

void GltfMaterialWriter::set_metal(const PrincipledMaterial& p, tinygltf::Material& out) {
  tinygltf::PbrMetallicRoughness& pbr = out.pbrMetallicRoughness;
  pbr.metallicFactor = unit(p.parameters.metallic);
  pbr.roughnessFactor = unit(p.parameters.roughness);
  if (!is_plain(p.metallic_texture, ImageChannel::blue) ||
      !is_plain(p.roughness_texture, ImageChannel::green))
    return;
  // One image has both.
  Texture metal = file_.textures[p.metallic_texture];
  metal.channel = ImageChannel::green;
  if (!(metal == file_.textures[p.roughness_texture])) return;
  set(p.metallic_texture, pbr.metallicRoughnessTexture);
  if (written_.contains(p.metallic_texture)) written_.insert(p.roughness_texture);
}

void GltfMaterialWriter::set_glass(const PrincipledMaterial& p, std::uint32_t interior,
                                   tinygltf::Material& out) {
  if (p.parameters.ior != 1.5f)
    extend(out, "KHR_materials_ior", {{"ior", Value(static_cast<double>(p.parameters.ior))}});
  if (p.parameters.transmission > 0) {
    Value::Object glass{{"transmissionFactor", Value(unit(p.parameters.transmission))}};
    if (is_plain(p.transmission_texture, ImageChannel::red))
      glass.emplace("transmissionTexture", Value(info(p.transmission_texture)));
    extend(out, "KHR_materials_transmission", std::move(glass));
    if (p.parameters.thin) return;
    if (p.parameters.dispersion > 0)
      extend(out, "KHR_materials_dispersion",
             {{"dispersion", Value(static_cast<double>(p.parameters.dispersion))}});
    Value::Object volume{{"thicknessFactor", Value(1.0)}};
    if (interior != kNoId && interior < file_.media.size()) {
      const Color& a = file_.media[interior].absorption;
      const double distance = 1 / static_cast<double>(max_component(a));
      Value::Array left;
      for (int k = 0; k < 3; ++k) left.emplace_back(std::exp(-static_cast<double>(a[k]) * distance));
      volume.emplace("attenuationDistance", Value(distance)), volume.emplace("attenuationColor", Value(left));
    }
    extend(out, "KHR_materials_volume", std::move(volume));
  }
}

void GltfMaterialWriter::set_specular(const PrincipledMaterial& p, tinygltf::Material& out) {
  const PrincipledParameters& n = p.parameters;
  const Color color = n.specular_color * (2 * n.specular);
  const bool has_textures = p.specular_weight_texture != kNoId || p.specular_color_texture != kNoId;
  if (n.specular_weight == 1 && color == Color{1, 1, 1} && !has_textures) return;
  Value::Object specular{{"specularFactor", Value(unit(n.specular_weight))},
                         {"specularColorFactor", Value(numbers(color))}};
  if (is_plain(p.specular_weight_texture, ImageChannel::alpha))
    specular.emplace("specularTexture", Value(info(p.specular_weight_texture)));
  if (is_plain(p.specular_color_texture, ImageChannel::red))
    specular.emplace("specularColorTexture", Value(info(p.specular_color_texture)));
  extend(out, "KHR_materials_specular", std::move(specular));
}

/// One image has direction and strength.
void GltfMaterialWriter::set_anisotropy(const PrincipledMaterial& p, tinygltf::Material& out) {
  if (p.parameters.anisotropy == 0) return;
  Value::Object anisotropy{{"anisotropyStrength", Value(unit(p.parameters.anisotropy))}};
  if (p.anisotropy_rotation != 0)
    anisotropy.emplace("anisotropyRotation", Value(double{p.anisotropy_rotation} * kDegree));
  const std::uint32_t direction = p.anisotropy_direction_texture;
  if (is_plain(p.anisotropy_texture, ImageChannel::blue) && is_plain(direction, ImageChannel::red)) {
    Texture strength = file_.textures[p.anisotropy_texture];
    strength.channel = ImageChannel::red;
    if (strength == file_.textures[direction]) {
      anisotropy.emplace("anisotropyTexture", Value(info(direction)));
      if (written_.contains(direction)) written_.insert(p.anisotropy_texture);
    }
  }
  extend(out, "KHR_materials_anisotropy", std::move(anisotropy));
}

void GltfMaterialWriter::set_iridescence(const PrincipledMaterial& p, tinygltf::Material& out) {
  const PrincipledParameters& n = p.parameters;
  if (n.iridescence == 0) return;
  const auto thickness = static_cast<double>(n.iridescence_thickness);
  Value::Object film{{"iridescenceFactor", Value(unit(n.iridescence))},
                     {"iridescenceIor", Value(static_cast<double>(n.iridescence_ior))}};
  if (is_plain(p.iridescence_texture, ImageChannel::red))
    film.emplace("iridescenceTexture", Value(info(p.iridescence_texture)));
  double least = thickness, most = thickness;
  if (p.iridescence_thickness_texture != kNoId) {
    const Texture& t = file_.textures[p.iridescence_thickness_texture];
    Texture plain = t;
    plain.gain = 1, plain.base = 0;
    const int index = t.channel == ImageChannel::green ? texture_of(plain) : -1;
    if (index >= 0) {
      tinygltf::TextureInfo use;
      use.index = index;
      place(t, use.texCoord, use.extensions);
      written_.insert(p.iridescence_thickness_texture);
      film.emplace("iridescenceThicknessTexture", Value(object_of(use)));
      least = thickness * double{t.base}, most = thickness * (double{t.base} + double{t.gain});
    }
  }
  film.emplace("iridescenceThicknessMinimum", Value(std::max(least, 0.0)));
  film.emplace("iridescenceThicknessMaximum", Value(std::max(most, 0.0)));
  extend(out, "KHR_materials_iridescence", std::move(film));
}

void GltfMaterialWriter::set_layers(const PrincipledMaterial& p, tinygltf::Material& out) {
  const PrincipledParameters& n = p.parameters;
  set_specular(p, out);
  if (n.coat > 0) {
    Value::Object coat{{"clearcoatFactor", Value(unit(n.coat))},
                       {"clearcoatRoughnessFactor", Value(unit(n.coat_roughness))}};
    if (is_plain(p.coat_texture, ImageChannel::red)) coat.emplace("clearcoatTexture", info(p.coat_texture));
    if (is_plain(p.coat_roughness_texture, ImageChannel::green))
      coat.emplace("clearcoatRoughnessTexture", info(p.coat_roughness_texture));
    tinygltf::NormalTextureInfo normals = p.even_coat ? tinygltf::NormalTextureInfo{} : out.normalTexture;
    if (p.coat_normal_texture != kNoId) {
      normals = {};
      set(p.coat_normal_texture, normals);
      normals.scale = double{p.coat_normal_scale};
    }
    Value::Object object = object_of(normals);
    object.emplace("scale", Value(normals.scale));
    coat.emplace("clearcoatNormalTexture", Value(std::move(object)));
    extend(out, "KHR_materials_clearcoat", std::move(coat));
  }
  if (n.sheen > 0) {
    Value::Object sheen{{"sheenColorFactor", Value(numbers(n.sheen_color * n.sheen))},
                        {"sheenRoughnessFactor", Value(unit(n.sheen_roughness))}};
    if (is_plain(p.sheen_color_texture, ImageChannel::red))
      sheen.emplace("sheenColorTexture", info(p.sheen_color_texture));
    if (is_plain(p.sheen_roughness_texture, ImageChannel::alpha))
      sheen.emplace("sheenRoughnessTexture", info(p.sheen_roughness_texture));
    extend(out, "KHR_materials_sheen", std::move(sheen));
  }
}

/// Whether it is a texture whose numbers are those of the channel.
bool GltfMaterialWriter::is_plain(std::uint32_t index, ImageChannel channel) const {
  if (index == kNoId) return false;
  const Texture& t = file_.textures[index];
  return t.channel == channel && t.gain == 1 && t.base == 0;
}

/// The index of the texture in the model; -1 if it cannot be.
int GltfMaterialWriter::texture(std::uint32_t index) {
  const int made = texture_of(file_.textures[index]);
  if (made >= 0) written_.insert(index);
  return made;
}

int GltfMaterialWriter::texture_of(const Texture& t) {
  const int source = t.pattern || !t.attribute.empty() || t.gain != 1 || t.base != 0 ? -1 : image(t);
  return source < 0 ? -1 : add_texture(t, source);
}

int GltfMaterialWriter::add_texture(const Texture& t, int image) {
  tinygltf::Texture out;
  out.source = image;
  out.sampler = sampler(t.lookup);
  model_.textures.push_back(out);
  return static_cast<int>(model_.textures.size()) - 1;
}

/// The index of a sampler in the model; -1 for the usual one.
int GltfMaterialWriter::sampler(TextureLookup lookup) {
  if (lookup == TextureLookup{}) return -1;
  constexpr auto code = [](TextureWrap w) {
    return w == TextureWrap::clamp    ? TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE
           : w == TextureWrap::mirror ? TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT
                                      : TINYGLTF_TEXTURE_WRAP_REPEAT;
  };
  tinygltf::Sampler made;
  made.wrapS = code(lookup.u), made.wrapT = code(lookup.v);
  if (lookup.magnified == TextureFilter::nearest) made.magFilter = TINYGLTF_TEXTURE_FILTER_NEAREST;
  for (std::size_t i = 0; i < model_.samplers.size(); ++i)
    if (model_.samplers[i] == made) return static_cast<int>(i);
  model_.samplers.push_back(std::move(made));
  return static_cast<int>(model_.samplers.size()) - 1;
}

/// The index of the texture's image in the model, as PNG if it is neither PNG nor JPEG; -1 if it cannot be
/// read.
int GltfMaterialWriter::image(const Texture& t) {
  const auto [found, is_new] = images_.try_emplace(t.path, -1);
  if (!is_new) return found->second;
  try {
    const std::string bytes = t.content ? *t.content : std::string(MappedFile(t.path).text());
    return add_image(t.path, mime_type(bytes).empty() ? png_of_texture(&t, nullptr) : bytes);
  } catch (const Error&) {
    return -1;
  }
}

int GltfMaterialWriter::add_image(const std::string& key, const std::string& bytes) {
  tinygltf::Image out;
  out.bufferView = add_gltf_view(model_, bytes.data(), bytes.size(), 0);
  out.mimeType = mime_type(bytes);
  model_.images.push_back(std::move(out));
  return images_[key] = static_cast<int>(model_.images.size()) - 1;
}

/// Says how a texture lies on surfaces.
void GltfMaterialWriter::place(const Texture& t, int& set, tinygltf::ExtensionMap& extensions) {
  set = t.uv_layer;
  if (!is_moved(t)) return;
  extensions["KHR_texture_transform"] = Value(transform_of(t));
  model_.extensionsUsed.push_back("KHR_texture_transform");
}

template <class Info>
void GltfMaterialWriter::set(std::uint32_t index, Info& info) {
  if (index == kNoId) return;
  info.index = texture(index);
  if (info.index >= 0) place(file_.textures[index], info.texCoord, info.extensions);
}

Value::Object GltfMaterialWriter::info(std::uint32_t index) {
  tinygltf::TextureInfo made;
  set(index, made);
  return object_of(made);
}

/// What says how a texture is used, as part of an extension. `extend` leaves it out if there is none.
template <class Info>
Value::Object GltfMaterialWriter::object_of(const Info& made) {
  Value::Object object{{"index", Value(made.index)}};
  if (made.texCoord != 0) object.emplace("texCoord", Value(made.texCoord));
  if (!made.extensions.empty())
    object.emplace("extensions", Value(Value::Object(made.extensions.begin(), made.extensions.end())));
  return object;
}

void GltfMaterialWriter::extend(tinygltf::Material& out, const char* name, Value::Object values) {
  std::erase_if(values, [](const auto& entry) {
    return entry.second.IsObject() && entry.second.Has("index") &&
           entry.second.Get("index").GetNumberAsInt() < 0;
  });
  out.extensions[name] = Value(std::move(values));
  model_.extensionsUsed.push_back(name);
}

void GltfMaterialWriter::note_losses(MeshLosses& losses) const {
  if (bumps_ > 0)
    losses.push_back("changed: " + count_of(bumps_, "bump map") +
                     ", as the normals of heights on a surface whose coordinates are everywhere as long");
  if (drawn_ > 0)
    losses.push_back("changed: " + count_of(drawn_, "image") + ", drawn anew with the opacity as alpha");
  note_lost_textures(file_.materials, written_, "glTF", losses);
}

}  // namespace oktett
