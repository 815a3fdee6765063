#pragma once
/// \file The parameters of the principled material as data.

#include <optional>

#include "core/description.h"
#include "core/vec3.h"

namespace oktett {

/// Greatest index of refraction of the principled material.
inline constexpr double kMostIor = 4;
inline constexpr Range kPrincipledIors{1 / kMostIor, kMostIor};

/// The complex index of refraction eta + i k of a metal, for each component of a colour.
struct Conductor {
  Color eta{0.2f, 0.92f, 1.1f};
  Color k{3.9f, 2.45f, 2.14f};
  bool operator==(const Conductor&) const = default;
};

/// The numbers of the principled material: NUMBER(name, default, range, meaning) for each. A roughness is the
/// root of the width of facets; below kLeastRoughness the lobe is delta.
#define OKTETT_PRINCIPLED_NUMBERS(NUMBER)                                              \
  NUMBER(metallic, 0, kUnitInterval, "weight of metal; the rest is plastic or glass")  \
  NUMBER(roughness, 0.5f, kUnitInterval, "from a mirror, 0, to 1")                     \
  NUMBER(specular, 0.5f, kUnitInterval,                                                \
         "scales the reflection of the opaque dielectric; 0.5 is what `ior` says")     \
  NUMBER(transmission, 0, kUnitInterval, "weight of glass in what is not metal")       \
  NUMBER(coat, 0, kUnitInterval, "weight of a clear coat")                             \
  NUMBER(coat_roughness, 0, kUnitInterval, "of the coat")                              \
  NUMBER(sheen, 0, kUnitInterval, "weight of fibres on top of all")                    \
  NUMBER(sheen_roughness, 0.3f, kUnitInterval, "of the fibres")                        \
  NUMBER(ior, 1.5f, kPrincipledIors, "index of refraction inside relative to outside") \
  NUMBER(coat_ior, 1.5f, (Range{1, kMostIor}), "index of refraction of the coat")
/// Its colours likewise: COLOR(name, default, meaning). The others are members of their own.
#define OKTETT_PRINCIPLED_COLORS(COLOR) COLOR(sheen_color, (Color{1, 1, 1}), "of the fibres")

/// See PrincipledLobes. Numbers are clamped to their ranges, colours to [0, 1].
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
  bool operator==(const PrincipledParameters&) const = default;
};

}  // namespace oktett
