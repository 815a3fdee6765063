#pragma once
/// \file The parameters of the principled material as data.

#include <optional>

#include "core/vec3.h"

namespace oktett {

/// Greatest index of refraction of the principled material.
inline constexpr double kMostIor = 4;

/// The complex index of refraction eta + i k of a metal, for each component of a colour.
struct Conductor {
  Color eta{0.2f, 0.92f, 1.1f};
  Color k{3.9f, 2.45f, 2.14f};
  bool operator==(const Conductor&) const = default;
};

/// See PrincipledLobes. Weights, colours and roughnesses are clamped to [0, 1].
struct PrincipledParameters {
  Color base_color{0.8f, 0.8f,
                   0.8f};  ///< of metal head-on, of diffuse light, of light that passes an interface
  float metallic = 0;      ///< weight of metal; the rest is dielectric
  float roughness = 0.5f;  ///< root of the width of facets. Below kLeastRoughness a delta lobe
  float specular = 0.5f;   ///< scales the reflectance head-on of the opaque dielectric by twice this
  float ior = 1.5f;        ///< index of refraction, inside relative to outside; [1/4, 4]
  float transmission = 0;  ///< weight of glass in the dielectric; the rest is opaque
  bool thin = false;       ///< glass is a thin wall: light passes without being bent
  float coat = 0;          ///< weight of a clear dielectric layer on top
  float coat_roughness = 0;
  float coat_ior = 1.5f;  ///< [1, 4]
  float sheen = 0;        ///< weight of fibres on top of all
  Color sheen_color{1, 1, 1};
  float sheen_roughness = 0.3f;
  std::optional<Conductor> conductor;  ///< of the metal, instead of base_color
  bool operator==(const PrincipledParameters&) const = default;
};

}  // namespace oktett
