#include "io/gltf/write_materials.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "io/gltf/materials.h"
#include "io/obj/material_textures.h"
#include "io/text/mapped_file.h"

namespace oktett {
namespace {

using tinygltf::Value;

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
  const double scale = t.scale.y;
  return {{"offset", Value(Value::Array{Value(double{t.offset.x}), Value(1 - scale - t.offset.y)})},
          {"scale", Value(Value::Array{Value(double{t.scale.x}), Value(scale)})}};
}

bool is_moved(const Texture& t) {
  return t.scale.x != 1 || t.scale.y != 1 || t.offset.x != 0 || t.offset.y != 0;
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

int GltfMaterialWriter::add(const Material& m) {
  if (m == Material{}) return -1;
  tinygltf::Material out;
  out.name = m.name;
  out.doubleSided = m.emits_behind;
  const PrincipledMaterial p = m.principled ? *m.principled : principled_like(m);
  set_base(m, out);
  set_emission(m, out);
  set_opacity(m, out);
  set_metal(p, out);
  set_glass(p, out);
  set_layers(p, out);
  set(m.normal_texture, out.normalTexture);
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

void GltfMaterialWriter::set_opacity(const Material& m, tinygltf::Material& out) {
  double& alpha = out.pbrMetallicRoughness.baseColorFactor[3];
  alpha = unit(m.opacity);
  if (m.opacity < 1) out.alphaMode = "BLEND";
  if (m.opacity_texture == kNoId || m.color_texture == kNoId) return;
  // glTF has one image for colour and opacity.
  const Texture &t = file_.textures[m.opacity_texture], &color = file_.textures[m.color_texture];
  if (t.channel != ImageChannel::alpha || t.path != color.path || t.content != color.content ||
      !written_.contains(m.color_texture))
    return;
  if (t.gain == 1 && t.base == 0) {
    out.alphaMode = "BLEND";
  } else if (t.gain >= 1 && t.gain <= kGltfMaskSlope) {
    out.alphaMode = "MASK";
    alpha = static_cast<double>(t.gain / kGltfMaskSlope);
    out.alphaCutoff = std::max(0.0, static_cast<double>((0.5f - t.base) / kGltfMaskSlope));
  } else {
    return;
  }
  written_.insert(m.opacity_texture);
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

void GltfMaterialWriter::set_glass(const PrincipledMaterial& p, tinygltf::Material& out) {
  if (p.parameters.ior != 1.5f)
    extend(out, "KHR_materials_ior", {{"ior", Value(static_cast<double>(p.parameters.ior))}});
  if (p.parameters.transmission > 0) {
    Value::Object glass{{"transmissionFactor", Value(unit(p.parameters.transmission))}};
    if (is_plain(p.transmission_texture, ImageChannel::red))
      glass.emplace("transmissionTexture", Value(info(p.transmission_texture)));
    extend(out, "KHR_materials_transmission", std::move(glass));
    if (!p.parameters.thin) extend(out, "KHR_materials_volume", {{"thicknessFactor", Value(1.0)}});
  }
}

void GltfMaterialWriter::set_layers(const PrincipledMaterial& p, tinygltf::Material& out) {
  const PrincipledParameters& n = p.parameters;
  if (n.specular != 0.5f || p.specular_texture != kNoId) {
    Value::Object specular{{"specularFactor", Value(unit(2 * n.specular))}};
    if (is_plain(p.specular_texture, ImageChannel::alpha))
      specular.emplace("specularTexture", Value(info(p.specular_texture)));
    extend(out, "KHR_materials_specular", std::move(specular));
  }
  if (n.coat > 0) {
    Value::Object coat{{"clearcoatFactor", Value(unit(n.coat))},
                       {"clearcoatRoughnessFactor", Value(unit(n.coat_roughness))}};
    if (is_plain(p.coat_texture, ImageChannel::red)) coat.emplace("clearcoatTexture", info(p.coat_texture));
    if (is_plain(p.coat_roughness_texture, ImageChannel::green))
      coat.emplace("clearcoatRoughnessTexture", info(p.coat_roughness_texture));
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
  const Texture& t = file_.textures[index];
  const int source = t.pattern || t.gain != 1 || t.base != 0 ? -1 : image(t);
  if (source < 0) return -1;
  written_.insert(index);
  tinygltf::Texture out;
  out.source = source;
  if (t.clamp) {
    if (model_.samplers.empty()) {
      model_.samplers.emplace_back();
      model_.samplers[0].wrapS = model_.samplers[0].wrapT = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    }
    out.sampler = 0;
  }
  model_.textures.push_back(out);
  return static_cast<int>(model_.textures.size()) - 1;
}

/// The index of the texture's image in the model; -1 if it is neither PNG nor JPEG or cannot be read.
int GltfMaterialWriter::image(const Texture& t) {
  const auto [found, is_new] = images_.try_emplace(t.path, -1);
  if (!is_new) return found->second;
  std::string bytes;
  try {
    bytes = t.content ? *t.content : std::string(MappedFile(t.path).text());
  } catch (const Error&) {
    return -1;
  }
  const std::string_view type = mime_type(bytes);
  if (type.empty()) return -1;
  tinygltf::Image out;
  out.bufferView = add_gltf_view(model_, bytes.data(), bytes.size(), 0);
  out.mimeType = type;
  model_.images.push_back(std::move(out));
  return found->second = static_cast<int>(model_.images.size()) - 1;
}

template <class Info>
void GltfMaterialWriter::set(std::uint32_t index, Info& info) {
  if (index == kNoId) return;
  info.index = texture(index);
  const Texture& t = file_.textures[index];
  if (info.index < 0 || !is_moved(t)) return;
  info.extensions["KHR_texture_transform"] = Value(transform_of(t));
  model_.extensionsUsed.push_back("KHR_texture_transform");
}

Value::Object GltfMaterialWriter::info(std::uint32_t index) {
  tinygltf::TextureInfo made;
  set(index, made);
  Value::Object object{{"index", Value(made.index)}};
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
  std::set<std::uint32_t> lost;
  for (Material m : file_.materials)
    for_each_texture(m, [&](std::uint32_t index) {
      if (index != kNoId && !written_.contains(index)) lost.insert(index);
    });
  if (!lost.empty())
    losses.push_back("lost: " + count_of(lost.size(), "texture") + ", which glTF cannot show as they are");
}

}  // namespace oktett
