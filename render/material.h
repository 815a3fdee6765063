#pragma once
/// \file Materials and textures as data.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/mesh.h"
#include "core/vec3.h"
#include "render/bsdf/principled_parameters.h"
#include "render/pattern.h"

namespace oktett {

/// A channel of an image as it is stored, or the luminance (Rec.709) of its colours as stored. An image
/// without alpha has 1 there.
enum class ImageChannel : std::uint8_t { red, green, blue, alpha, luminance };

/// How the colours of an image are encoded: as its file says, or whatever it says as sRGB or linear.
enum class TextureColors : std::uint8_t { of_file, srgb, linear };

/// What an image shows beyond its edges.
enum class TextureWrap : std::uint8_t { repeat, clamp, mirror };
/// What an image shows between the middles of its pixels where they are larger than those of the picture: a
/// blend of the four about a place, or the one that the place is in.
enum class TextureFilter : std::uint8_t { linear, nearest };
/// How an image is looked up.
struct TextureLookup {
  TextureWrap u = TextureWrap::repeat, v = TextureWrap::repeat;
  TextureFilter magnified = TextureFilter::linear;
  bool operator==(const TextureLookup&) const = default;
};
inline constexpr TextureLookup kClampedTexture{TextureWrap::clamp, TextureWrap::clamp};

/// An image file and how it is laid over the uv square, a pattern, or an attribute of meshes. ImageTextures
/// reads the file.
struct Texture {
  std::string path;                         ///< of the image; else empty
  TextureLookup lookup{};                   ///< beyond the edges (MTL `-clamp on`: clamped) and close up
  Vec3f offset{0, 0, 0};                    ///< added to uv after scaling and turning (MTL `-o`)
  Vec3f scale{1, 1, 1};                     ///< multiplies uv (MTL `-s`)
  float rotation = 0;                       ///< turns scaled uv counter-clockwise about (0, 0); radians
  float gain = 1;                           ///< multiplies the texel (MTL `-mm base gain`)
  float base = 0;                           ///< added to the texel (MTL `-mm base gain`)
  std::optional<PatternTexture> pattern{};  ///< instead of an image; only gain and base apply to it
  /// What a number is taken from (colours and normals are those of all channels).
  ImageChannel channel = ImageChannel::red;
  TextureColors color_space = TextureColors::of_file;  ///< of a colour (MTL `-colorspace`)
  std::uint8_t uv_layer = 0;  ///< of what meshes have: 0 for TriangleMesh::uvs, 1 for second_uvs
  /// If not null, the bytes of the image file; `path` is only its name then.
  std::shared_ptr<const std::string> content{};
  /// Instead of an image, if not empty: the attribute of this name of the mesh that is hit, see attribute_at.
  /// Only gain, base and channel apply to it. What has no such attribute shows white.
  std::string attribute{};
  bool operator==(const Texture&) const = default;
};

/// A material whose parameters are those of the principled model, see PrincipledParameters. Textures are
/// indices into Scene::textures or kNoId; each multiplies its parameter.
struct PrincipledMaterial {
  PrincipledParameters parameters;  ///< base_color is that of Material::color, with its texture
#define OKTETT_TEXTURE(name, ...) std::uint32_t name##_texture = kNoId;
  OKTETT_PRINCIPLED_NUMBERS(OKTETT_TEXTURE)
  OKTETT_PRINCIPLED_COLORS(OKTETT_TEXTURE)
#undef OKTETT_TEXTURE
  /// Of colours of `parameters.conductor`, if that is given.
  std::uint32_t eta_texture = kNoId, k_texture = kNoId;
  /// Tangent-space normals of the coat, and the factor of their tilt. Without them, it has the normals of
  /// what lies below, or if it is even those without bumps.
  std::uint32_t coat_normal_texture = kNoId;
  float coat_normal_scale = 1;
  bool even_coat = false;
  /// Where `anisotropy` widens facets: degrees from the tangent towards the bitangent, and an image whose red
  /// and green are the direction from which they count, 0.5 being 0.
  float anisotropy_rotation = 0;
  std::uint32_t anisotropy_direction_texture = kNoId;
  /// Whitted's model shows at each hit what comes near to the parameters there, see resemble_principled;
  /// false: it shows the numbers of Material.
  bool resembled = false;
  bool operator==(const PrincipledMaterial&) const = default;
};

/// A number of the principled material, its name and meaning in scene files, the texture that multiplies it,
/// and the range to which the product is clamped.
struct PrincipledNumber {
  const char* name;
  float PrincipledParameters::*value;
  std::uint32_t PrincipledMaterial::*texture;
  Range range;
  const char* meaning;
};
inline constexpr PrincipledNumber kPrincipledNumbers[] = {
#define OKTETT_ROW(name, usual, range, meaning) \
  {#name, &PrincipledParameters::name, &PrincipledMaterial::name##_texture, range, meaning},
    OKTETT_PRINCIPLED_NUMBERS(OKTETT_ROW)
#undef OKTETT_ROW
};

/// A colour likewise.
struct PrincipledColor {
  const char* name;
  Color PrincipledParameters::*value;
  std::uint32_t PrincipledMaterial::*texture;
  const char* meaning;
};
inline constexpr PrincipledColor kPrincipledColors[] = {
#define OKTETT_ROW(name, usual, meaning) \
  {#name, &PrincipledParameters::name, &PrincipledMaterial::name##_texture, meaning},
    OKTETT_PRINCIPLED_COLORS(OKTETT_ROW)
#undef OKTETT_ROW
};

/// The priority of materials that have none: lower than all others.
inline constexpr std::int32_t kNoPriority = -1;

/// A material of the Whitted model. The light that leaves a point is the sum of
/// - emission,
/// - color * (ambient * ambient light + diffuse * sum over lights, by the cosine to the power of brilliance;
///   diffuse_back for lights behind the surface),
/// - specular_color * (specular * Phong's highlights + specular_blinn * Blinn's highlights),
/// - reflection_color * reflection * reflected ray,
/// - transparency * (refracted and reflected ray, split by Fresnel's equations).
struct Material {
  std::string name;
  Color color{0.8f, 0.8f, 0.8f};            ///< colour of diffuse and ambient light
  Color specular_color{1, 1, 1};            ///< colour of highlights and mirror reflections
  std::optional<Color> reflection_color{};  ///< of mirror reflections; not given: `specular_color`
  Color emission{0, 0, 0};                  ///< radiance
  bool emits_behind = true;                 ///< both sides glow; false: only that of the geometric normal
  std::string light_group{};                ///< of `emission`; empty: the default group
  float ambient = 0.1f;                     ///< [0, inf)
  float diffuse = 0.8f;                     ///< [0, inf)
  float specular = 0;                       ///< weight of the Phong highlight, [0, inf)
  float phong = 32;                         ///< Phong exponent, [0, inf)
  /// Diffuse light of a lamp is that part of it that the cosine to the normal to this power is, [0, inf): 1
  /// is Lambert's law, more leaves less light towards the edge of what is lit.
  float brilliance = 1;
  /// Weight and exponent of a highlight by the cosine between the normal and the direction halfway between
  /// light and viewer (Blinn 1977), [0, inf).
  float specular_blinn = 0, blinn = 128;
  /// In Whitted's model: the most that is taken at random, from place to place, from the diffuse light of
  /// each lamp, [0, inf).
  float grain = 0;
  /// In Whitted's model: `diffuse` for lamps on the other side than the viewer, [0, inf).
  float diffuse_back = 0;
  /// In Whitted's model: how much a thin film colours the light of lamps and mirrors, and its thickness in
  /// nanometres, both [0, inf); see film_color().
  float film = 0, film_thickness = 400;
  float reflection = 0;  ///< weight of the mirror ray, [0, 1]; of one that varies, head-on
  /// If reflection_varies, the weight of the mirror ray at grazing angles, [0, 1]. Between it grows with 1 -
  /// c to the power of the falloff, > 0, c being the cosine of the angle to the normal; or, if that is 0, as
  /// Fresnel's equations say of `ior`.
  float reflection_grazing = 0, reflection_falloff = 1;
  bool reflection_varies = false;
  float transparency = 0;         ///< weight of light that passes through, [0, 1]; 0 = opaque
  std::optional<Color> filter{};  ///< colour of that light (MTL `Tf`); not given: `color`, with its texture
  float ior = 1.5f;               ///< index of refraction inside relative to outside, > 0
  // In Whitted's model:
  bool fresnel = true;  ///< transparency is split by Fresnel's equations; false: all of it is refracted, and
                        ///< where nothing can be, all light is mirrored
  bool conserve_energy = false;  ///< what the weight of the mirror ray takes is not refracted
  /// The colours of highlights, and of the mirror ray, turn white towards grazing angles; see metal_fade().
  bool specular_fades = false, reflection_fades = false;
  float opacity = 1;  ///< part of the surface that is there, [0, 1]; the rest is holes
  /// If given, path tracing scatters light by it. Emission, opacity, bumps and normals are those of the other
  /// members, and so is all that Whitted's model shows of a material without textures: see
  /// resemble_principled.
  std::optional<PrincipledMaterial> principled;
  std::uint32_t color_texture = kNoId;     ///< index into Scene::textures; multiplies `color` (map_Kd)
  std::uint32_t specular_texture = kNoId;  ///< multiplies `specular_color` (map_Ks)
  std::uint32_t emission_texture = kNoId;  ///< multiplies `emission` (map_Ke)
  std::uint32_t opacity_texture =
      kNoId;                           ///< multiplies `opacity`, 0 in the image is fully see-through (map_d)
  std::uint32_t bump_texture = kNoId;  ///< height, perturbs the shading normal (map_Bump)
  std::uint32_t normal_texture = kNoId;  ///< tangent-space normal (norm)
  float bump_scale = 1;                  ///< MTL `-bm`
  float normal_scale = 1;                ///< multiplies the tilt of mapped normals
  // Each multiplies the number of its name.
  std::uint32_t ambient_texture = kNoId, diffuse_texture = kNoId, specular_weight_texture = kNoId;
  std::uint32_t phong_texture = kNoId, reflection_texture = kNoId, transparency_texture = kNoId;
  std::uint32_t reflection_grazing_texture = kNoId, reflection_color_texture = kNoId;
  std::uint32_t brilliance_texture = kNoId, specular_blinn_texture = kNoId, blinn_texture = kNoId;
  std::uint32_t grain_texture = kNoId, diffuse_back_texture = kNoId;
  std::uint32_t film_texture = kNoId, film_thickness_texture = kNoId;
  std::uint32_t ior_texture = kNoId, filter_texture = kNoId;
  /// These multiply `color` and `opacity` once more: colours of vertices beside an image.
  std::uint32_t tint_texture = kNoId, tint_opacity_texture = kNoId;
  /// False: the boundary of the interior has no surface, and light passes it as if it were not there.
  bool surface = true;
  std::uint32_t interior = kNoId;  ///< index into Scene::media: what fills solids of this material
  /// Where solids overlap, the one of higher priority, >= 0, fills the space. Its index of refraction then
  /// counts relative to the solid around it that has a priority, too.
  std::int32_t priority = kNoPriority;
  /// Index into Scene::materials: what is seen from the side from which the normal points away. Shadows, and
  /// what is inside, are those of this material.
  std::uint32_t back = kNoId;
  bool operator==(const Material&) const = default;
};

/// Whether surfaces of the material give off light of their own, on one side at least.
inline bool glows(const Material& m) { return !(m.emission == Color{0, 0, 0}); }

/// A number of Phong's model, likewise.
struct PhongNumber {
  const char* name;
  float Material::*value;
  std::uint32_t Material::*texture;
  const char* meaning;
  Range range = kNonNegative;
};
inline constexpr PhongNumber kPhongNumbers[] = {
    {"ambient", &Material::ambient, &Material::ambient_texture, "weight of ambient light"},
    {"diffuse", &Material::diffuse, &Material::diffuse_texture, "weight of diffuse light"},
    {"specular", &Material::specular, &Material::specular_weight_texture, "weight of highlights"},
    {"phong", &Material::phong, &Material::phong_texture, "exponent of the highlight"},
    {"reflection", &Material::reflection, &Material::reflection_texture, "weight of the mirrored ray",
     kUnitInterval},
    {"transparency", &Material::transparency, &Material::transparency_texture,
     "weight of light that passes through", kUnitInterval},
    {"reflection_grazing", &Material::reflection_grazing, &Material::reflection_grazing_texture,
     "weight of the mirrored ray at grazing angles, if it is not that of `reflection`", kUnitInterval},
    {"brilliance", &Material::brilliance, &Material::brilliance_texture,
     "power of the cosine by which diffuse light falls off"},
    {"specular_blinn", &Material::specular_blinn, &Material::specular_blinn_texture,
     "weight of highlights by Blinn"},
    {"blinn", &Material::blinn, &Material::blinn_texture, "exponent of Blinn's highlight"},
    {"grain", &Material::grain, &Material::grain_texture,
     "`whitted`: most that is taken at random from the diffuse light of a lamp"},
    {"diffuse_back", &Material::diffuse_back, &Material::diffuse_back_texture,
     "`whitted`: weight of diffuse light of lamps on the other side"},
    {"film", &Material::film, &Material::film_texture,
     "`whitted`: how much a thin film colours light of lamps and mirrors"},
    {"film_thickness", &Material::film_thickness, &Material::film_thickness_texture,
     "its thickness in nanometres"}};

/// Calls f(index) for each member of a material, which may be const, that is an index of a texture.
template <class AnyMaterial, class F>
OKTETT_INLINE void for_each_texture(AnyMaterial& m, F&& f) {
  f(m.color_texture), f(m.specular_texture), f(m.emission_texture);
  f(m.opacity_texture), f(m.bump_texture), f(m.normal_texture);
  for (const PhongNumber& number : kPhongNumbers) f(m.*number.texture);
  f(m.ior_texture), f(m.filter_texture), f(m.reflection_color_texture), f(m.tint_texture),
      f(m.tint_opacity_texture);
  if (!m.principled) return;
  for (const PrincipledNumber& number : kPrincipledNumbers) f((*m.principled).*number.texture);
  for (const PrincipledColor& color : kPrincipledColors) f((*m.principled).*color.texture);
  f(m.principled->eta_texture), f(m.principled->k_texture), f(m.principled->coat_normal_texture);
  f(m.principled->anisotropy_direction_texture);
}

/// Calls f(index) for each texture in `list` that a texture shows, itself first.
template <class F>
void for_each_shown_texture(std::span<const Texture> list, std::uint32_t texture, F&& f, unsigned depth = 0) {
  if (texture >= list.size() || depth > kMostNestedTextures) return;
  f(texture);
  if (list[texture].pattern)
    for_each_nested_texture(*list[texture].pattern, [&](const std::uint32_t& nested) {
      for_each_shown_texture(list, nested, f, depth + 1);
    });
}

/// The range of a textured Material::ior.
inline constexpr Range kPhongIors{1e-3, 1e3};

/// A bound on the part of light that a material of Phong's model gives back in all, where it gives back most.
/// `textures` are Scene::textures, of whose images all texels count as [0, 1]. Above 1 it makes energy.
float greatest_albedo(const Material& m, std::span<const Texture> textures);

/// The principled material of the colour, roughness, index of refraction and transparency of a Phong
/// material.
PrincipledMaterial principled_like(const Material& m);

/// The numbers of kPhongNumbers at a place, in that order.
struct PhongValues {
  float ambient, diffuse, specular, phong, reflection, transparency, reflection_grazing;
  float brilliance = 1, specular_blinn = 0, blinn = 128, grain = 0;
  float diffuse_back = 0, film = 0, film_thickness = 400;
};

/// What comes near to principled parameters in Whitted's model: smooth metal is a mirror, smooth glass is
/// glass, and rougher surfaces have a highlight of about their width.
PhongValues resembling_values(const PrincipledParameters& p);
/// The colour of its highlights and mirrors.
Color resembling_specular_color(const PrincipledParameters& p);

/// The part of light that a surface of these weights, within [0, 1], lets pass as glass does.
OKTETT_INLINE float glass_weight(float metallic, float transmission) { return (1 - metallic) * transmission; }

/// Sets the parameters of the Whitted model to what comes near to `m.principled`, which must be given, where
/// its textures are white; but the transparency is that where most light passes.
void resemble_principled(Material& m);

}  // namespace oktett
