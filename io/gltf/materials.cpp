#include "io/gltf/gltf_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "core/math.h"
#include "io/obj/mtl_texture.h"
#include "render/material.h"

namespace oktett {
namespace {

using namespace std::string_view_literals;

/// Whether the bytes begin like an image of the kinds that glTF knows.
bool is_known_image(std::string_view bytes) {
  return bytes.starts_with("\x89PNG\r\n"sv) || bytes.starts_with("\xff\xd8\xff"sv) ||
         (bytes.starts_with("RIFF"sv) &&
          bytes.substr(std::min<std::size_t>(bytes.size(), 8)).starts_with("WEBP"sv));
}

/// Converts all materials of a file.
class Materials {
 public:
  Materials(const GltfFile& file, FileScene& scene) : file_(file), scene_(scene), list_(scene.textures) {}

  void run() {
    find_colors();
    for (const GltfMaterial& m : file_.model().materials) {
      colors_ = colors_of_[scene_.materials.size()];
      scene_.materials.push_back(convert(m));
    }
    scene_.texture_places.assign(scene_.textures.size(), Location{file_.path()});
  }

 private:
  /// What COLOR_0 says of the primitives of a material.
  struct Colors {
    bool any = false, alpha = false;
  };

  void find_colors() {
    const GltfModel& model = file_.model();
    colors_of_.resize(model.materials.size());
    for (const GltfMesh& mesh : model.meshes)
      for (const GltfPrimitive& primitive : mesh.primitives) {
        if (primitive.material == kNoId) continue;
        Colors& colors = colors_of_[primitive.material];
        for (const GltfCarried& carried : primitive.attributes.carried) {
          if (!carried.is_color || carried.name != kColorAttribute) continue;
          const GltfAccessor& accessor = model.accessors[carried.number];
          colors.any = colors.any || accessor.components >= 3;
          colors.alpha = colors.alpha || accessor.components == 4;
        }
      }
  }

  Material convert(const GltfMaterial& in) {
    uv_sets_ = gltf_uv_sets(in);
    Material m;
    m.name = in.name;
    m.color = in.base_color;
    m.emission = in.emission, m.emits_behind = in.double_sided;
    m.color_texture = add(in.base_texture);
    m.normal_texture = add(in.normal_texture);
    m.normal_scale = in.normal_scale;
    m.emission_texture = add(in.emission_texture);
    set_opacity(in, m);
    if (colors_.any) m.tint_texture = add_colors(ImageChannel::red);
    PrincipledMaterial principled;
    set_surface(in, principled);
    if (in.unlit) {
      // What it shows does not depend on light.
      m.emission = in.base_color, m.emission_texture = m.color_texture, m.emits_behind = true;
      if (colors_.any && m.emission_texture == kNoId)
        m.emission_texture = m.tint_texture;
      else if (colors_.any)
        warn(in, "colours of vertices are not shown beside the image of an unlit material");
      m.color = {0, 0, 0}, m.color_texture = m.tint_texture = kNoId;
      principled = {};
      principled.parameters.specular = 0, principled.parameters.roughness = 1;
    }
    set_interior(in, m);
    principled.parameters.base_color = m.color;
    m.principled = principled;
    resemble_principled(m);
    note_uv_sets(in);
    return m;
  }

  /// Light is absorbed on its way through what is filled.
  void set_interior(const GltfMaterial& in, Material& m) {
    constexpr float kLeast = 1e-6f;
    if (in.attenuation_distance <= 0 || in.thickness == 0 || in.transmission == 0) return;
    if (in.attenuation == Color{1, 1, 1}) return;
    Medium medium;
    medium.name = in.name;
    for (int k = 0; k < 3; ++k)
      medium.absorption[k] = static_cast<float>(
          -portable::log(static_cast<double>(std::max(in.attenuation[k], kLeast))) / in.attenuation_distance);
    if (!(max_component(medium.absorption) <= kMostAbsorption)) return;
    m.interior = static_cast<std::uint32_t>(scene_.media.size());
    scene_.media.push_back(std::move(medium));
  }

  void set_opacity(const GltfMaterial& in, Material& m) {
    if (in.alpha_mode == GltfMaterial::Alpha::opaque) return;
    if (in.alpha_mode == GltfMaterial::Alpha::blend) {
      m.opacity = in.alpha;
      m.opacity_texture = add(in.base_texture, ImageChannel::alpha);
      if (colors_.alpha) m.tint_opacity_texture = add_colors(ImageChannel::alpha);
    } else if (in.base_texture.texture == kNoId && colors_.alpha) {
      m.opacity_texture = add_colors(ImageChannel::alpha, kGltfMaskSlope * in.alpha,
                                     kGltfMaskAtCutoff - kGltfMaskSlope * in.alpha_cutoff);
    } else if (in.base_texture.texture == kNoId) {
      m.opacity = in.alpha >= in.alpha_cutoff ? 1 : 0;
    } else {
      m.opacity_texture = add(in.base_texture, ImageChannel::alpha, kGltfMaskSlope * in.alpha,
                              kGltfMaskAtCutoff - kGltfMaskSlope * in.alpha_cutoff);
      if (colors_.alpha) warn(in, "alpha of vertices is not shown beside that of an image where it masks");
    }
  }

  /// The colours that meshes carry, or a number gain * value + base of them.
  std::uint32_t add_colors(ImageChannel channel, float gain = 1, float base = 0) {
    Texture texture;
    texture.attribute = kColorAttribute;
    texture.channel = channel, texture.gain = gain, texture.base = base;
    return list_.add(texture);
  }

  void warn(const GltfMaterial& m, const std::string& message) {
    scene_.warnings.push_back({Location{file_.path()}, "material '" + m.name + "': " + message});
  }

  void set_surface(const GltfMaterial& in, PrincipledMaterial& out) {
    PrincipledParameters& p = out.parameters;
    p.metallic = in.metallic, p.roughness = in.roughness;
    out.metallic_texture = add(in.metallic_roughness_texture, ImageChannel::blue);
    out.roughness_texture = add(in.metallic_roughness_texture, ImageChannel::green);
    if (in.is_glossy) {
      const bool shows_texture = in.gloss_texture.texture != kNoId;
      p.roughness = shows_texture ? 1 : 1 - in.gloss;
      out.roughness_texture = add(in.gloss_texture, ImageChannel::alpha, -in.gloss, 1);
    }
    p.ior = std::clamp(in.ior == 0 ? 4.0f : in.ior, 1.0f, 4.0f);
    set_specular(in, out);
    p.transmission = in.transmission, p.thin = in.thickness == 0;
    out.transmission_texture = add(in.transmission_texture, ImageChannel::red);
    p.coat = in.coat, p.coat_roughness = in.coat_roughness;
    out.coat_texture = add(in.coat_texture, ImageChannel::red);
    out.coat_roughness_texture = add(in.coat_roughness_texture, ImageChannel::green);
    if (in.coat > 0) set_coat_normals(in, out);
    set_anisotropy(in, out);
    set_iridescence(in, out);
    if (in.transmission > 0 && !p.thin) p.dispersion = in.dispersion;
    if (in.sheen_color == Color{0, 0, 0}) return;
    p.sheen = 1, p.sheen_color = in.sheen_color, p.sheen_roughness = in.sheen_roughness;
    out.sheen_color_texture = add(in.sheen_color_texture);
    out.sheen_roughness_texture = add(in.sheen_roughness_texture, ImageChannel::alpha);
  }

  /// A coat without normals of its own is even. One with those of the surface follows it.
  void set_coat_normals(const GltfMaterial& in, PrincipledMaterial& out) {
    if (in.coat_normal_texture == in.normal_texture && in.coat_normal_scale == in.normal_scale) return;
    out.coat_normal_texture = add(in.coat_normal_texture);
    out.coat_normal_scale = in.coat_normal_scale;
    out.even_coat = out.coat_normal_texture == kNoId;
  }

  /// One image has the direction and, in its blue channel, the strength.
  void set_anisotropy(const GltfMaterial& in, PrincipledMaterial& out) {
    if (in.anisotropy == 0) return;
    out.parameters.anisotropy = in.anisotropy;
    out.anisotropy_rotation = static_cast<float>(in.anisotropy_rotation / kDegree);
    out.anisotropy_texture = add(in.anisotropy_texture, ImageChannel::blue);
    out.anisotropy_direction_texture = add(in.anisotropy_texture);
  }

  /// The image leads from the least thickness to the greatest; without it the greatest counts.
  void set_iridescence(const GltfMaterial& in, PrincipledMaterial& out) {
    if (in.iridescence == 0) return;
    PrincipledParameters& p = out.parameters;
    p.iridescence = in.iridescence;
    p.iridescence_ior = std::clamp(in.iridescence_ior, 1.0f, static_cast<float>(kMostIor));
    out.iridescence_texture = add(in.iridescence_texture, ImageChannel::red);
    p.iridescence_thickness = in.most_thickness;
    if (in.thickness_texture.texture == kNoId) return;
    if (in.most_thickness == 0) p.iridescence_thickness = in.least_thickness;
    if (p.iridescence_thickness == 0) return;
    out.iridescence_thickness_texture =
        add(in.thickness_texture, ImageChannel::green,
            (in.most_thickness - in.least_thickness) / p.iridescence_thickness,
            in.least_thickness / p.iridescence_thickness);
  }

  /// KHR_materials_specular. An index of refraction out of range is clamped; the colour makes up for what it
  /// would reflect head-on.
  void set_specular(const GltfMaterial& in, PrincipledMaterial& out) {
    PrincipledParameters& p = out.parameters;
    const auto head_on = [](float ior) { return (ior - 1) * (ior - 1) / ((ior + 1) * (ior + 1)); };
    Color color = in.specular_color;
    if (in.ior == 0 || in.ior > p.ior) color = color * ((in.ior == 0 ? 1 : head_on(in.ior)) / head_on(p.ior));
    // A grey one is what `specular` says.
    constexpr float kUsual = 0.5f;
    const float most = max_component(color);
    const bool is_grey = color == Color{most, most, most} && kUsual * most <= 1;
    p.specular = is_grey ? kUsual * most : kUsual;
    p.specular_color = is_grey ? Color{1, 1, 1} : color;
    p.specular_weight = in.specular;
    out.specular_color_texture = add(in.specular_color_texture);
    out.specular_weight_texture = add(in.specular_texture, ImageChannel::alpha);
    if (in.transmission > 0 &&
        (in.specular != 1 || !(in.specular_color == Color{1, 1, 1}) || in.specular_texture.texture != kNoId ||
         in.specular_color_texture.texture != kNoId))
      warn(in,
           "its glass reflects as its index of refraction says; KHR_materials_specular does not change that");
  }

  /// Adds the texture, whose number is gain * texel + base, and returns its index; kNoId for none.
  std::uint32_t add(const GltfTextureUse& use, ImageChannel channel = ImageChannel::red, float gain = 1,
                    float base = 0) {
    if (use.texture == kNoId) return kNoId;
    const GltfTexture& in = file_.model().textures[use.texture];
    if (in.image == kNoId) return kNoId;  // white
    Texture texture;
    texture.lookup = in.lookup, texture.channel = channel, texture.gain = gain, texture.base = base;
    texture.uv_layer = use.uvs == uv_sets_.second ? 1 : 0;
    texture.color_space = TextureColors::srgb;
    // Here v points up.
    const float c = static_cast<float>(std::cos(use.rotation)),
                s = static_cast<float>(std::sin(use.rotation));
    texture.rotation = static_cast<float>(use.rotation);
    texture.scale = {use.scale.x, use.scale.y, 1};
    texture.offset = {use.offset.x + s * use.scale.y, 1 - c * use.scale.y - use.offset.y, 0};
    set_image(in.image, texture);
    return list_.add(texture);
  }

  void set_image(std::uint32_t number, Texture& texture) {
    const auto [found, is_new] = images_.try_emplace(number);
    if (is_new) found->second = image(number);
    texture.path = found->second.path, texture.content = found->second.content;
  }

  /// The path and content of an image.
  Texture image(std::uint32_t number) {
    const GltfSource& source = file_.model().images[number];
    const std::string where = "images[" + std::to_string(number) + "]";
    Texture texture;
    std::string bytes;
    if (source.view != kNoId)
      bytes = file_.bytes(file_.model().views[source.view].range, where);
    else if (source.data_uri != kNoId)
      bytes = file_.data_uri(source.data_uri, where);
    else if (source.uri.starts_with("data:"))
      bytes = decode_data_uri(file_.path(), where, source.uri);
    else
      texture.path = file_.path_of(source.uri, where);
    if (!texture.path.empty()) return texture;
    if (is_known_image(bytes)) {
      texture.path = file_.path() + ", " + where;
      texture.content = std::make_shared<const std::string>(std::move(bytes));
    } else {
      scene_.warnings.push_back(
          {Location{file_.path()}, where + ": is no PNG, JPEG or WebP image; white instead"});
    }
    return texture;
  }

  void note_uv_sets(const GltfMaterial& m) {
    bool differ = false;
    for_each_texture_use(m, [&](const GltfTextureUse& use) {
      differ = differ || (use.uvs != uv_sets_.first && use.uvs != uv_sets_.second);
    });
    if (differ)
      warn(m,
           "its textures lie by more than two sets of coordinates; the first of them is used for the others");
  }

  static constexpr float kMostAbsorption = 1e30f;

  const GltfFile& file_;
  FileScene& scene_;
  TextureList list_;
  UvSets uv_sets_;  ///< of the material that is converted
  Colors colors_;   ///< likewise
  std::vector<Colors> colors_of_;
  std::map<std::uint32_t, Texture> images_;
};

}  // namespace

void add_gltf_materials(const GltfFile& file, FileScene& scene) { Materials(file, scene).run(); }

}  // namespace oktett
