#pragma once
/// \file The parameters of the principled material as data.

#include <optional>

#include "core/description.h"
#include "core/vec3.h"

namespace oktett {

/// Greatest index of refraction of the principled material.
inline constexpr double kMostIor = 4;
inline constexpr Range kPrincipledIors{1 / kMostIor, kMostIor};
/// Greatest thickness of a thin film, nanometres.
inline constexpr double kMostFilm = 1e5;
/// Greatest dispersion: that of an Abbe number of 1.
inline constexpr double kMostDispersion = 20;

/// The complex index of refraction eta + i k of a metal, for each component of a colour.
struct Conductor {
  Color eta{0.2f, 0.92f, 1.1f};
  Color k{3.9f, 2.45f, 2.14f};
  bool operator==(const Conductor&) const = default;
};

/// The numbers of the principled material: NUMBER(name, default, range, meaning) for each. A roughness is the
/// root of the width of facets; below kLeastRoughness the lobe is delta.
#define OKTETT_PRINCIPLED_NUMBERS(NUMBER)                                                 \
  NUMBER(metallic, 0, kUnitInterval, "weight of metal; the rest is plastic or glass")     \
  NUMBER(roughness, 0.5f, kUnitInterval, "from a mirror, 0, to 1")                        \
  NUMBER(specular, 0.5f, kUnitInterval,                                                   \
         "scales the reflection of the opaque dielectric; 0.5 is what `ior` says")        \
  NUMBER(specular_weight, 1, kUnitInterval, "the same, but at all angles alike")          \
  NUMBER(anisotropy, 0, kUnitInterval, "how much wider facets are along a direction")     \
  NUMBER(iridescence, 0, kUnitInterval, "weight of a thin film on top of the base")       \
  NUMBER(iridescence_ior, 1.3f, (Range{1, kMostIor}), "index of refraction of the film")  \
  NUMBER(iridescence_thickness, 400, (Range{0, kMostFilm}), "of the film, in nanometres") \
  NUMBER(dispersion, 0, (Range{0, kMostDispersion}), "20 over the Abbe number of glass")  \
  NUMBER(transmission, 0, kUnitInterval, "weight of glass in what is not metal")          \
  NUMBER(coat, 0, kUnitInterval, "weight of a clear coat")                                \
  NUMBER(coat_roughness, 0, kUnitInterval, "of the coat")                                 \
  NUMBER(sheen, 0, kUnitInterval, "weight of fibres on top of all")                       \
  NUMBER(sheen_roughness, 0.3f, kUnitInterval, "of the fibres")                           \
  NUMBER(ior, 1.5f, kPrincipledIors, "index of refraction inside relative to outside")    \
  NUMBER(coat_ior, 1.5f, (Range{1, kMostIor}), "index of refraction of the coat")
/// Its colours likewise: COLOR(name, default, meaning). The others are members of their own.
#define OKTETT_PRINCIPLED_COLORS(COLOR)                                                                   \
  COLOR(specular_color, (Color{1, 1, 1}), "multiplies what the opaque dielectric reflects head-on, to 1") \
  COLOR(sheen_color, (Color{1, 1, 1}), "of the fibres")

/// See PrincipledLobes. Numbers are clamped to their ranges, colours but specular_color to [0, 1].
struct PrincipledParameters {
  /// Of metal head-on, of diffuse light, of light that passes an interface.
  Color base_color{0.8f, 0.8f, 0.8f};
#define OKTETT_NUMBER(name, usual, range, meaning) float name = usual;
#define OKTETT_COLOR(name, usual, meaning) Color name = usual;
  OKTETT_PRINCIPLED_NUMBERS(OKTETT_NUMBER)
  OKTETT_PRINCIPLED_COLORS(OKTETT_COLOR)
#undef OKTETT_NUMBER
#undef OKTETT_COLOR
  bool thin = false;                   ///< glass is a thin wall: light passes without being bent
  std::optional<Conductor> conductor;  ///< of the metal, instead of base_color
  /// The normal of the coat, of any length, in the frame of a hit (ShadingFrame).
  Vec3f coat_normal{0, 0, 1};
  /// The direction along which `anisotropy` widens facets: cosine and sine in the same frame, of the angle to
  /// its x axis.
  Vec2f stretch{1, 0};
  bool operator==(const PrincipledParameters&) const = default;
};

}  // namespace oktett
