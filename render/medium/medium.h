#pragma once
/// \file Media as data: fog, smoke, liquids, coloured glass.

#include <cstdint>
#include <memory>
#include <string>

#include "core/description.h"
#include "core/transform.h"
#include "core/vec3.h"
#include "render/medium/density_grid.h"

namespace oktett {

/// Greatest magnitude of Medium::anisotropy.
inline constexpr float kMostAnisotropy = 0.999f;

/// Which way light is scattered, by the cosine c of the angle to its way, up to a factor.
enum class PhaseKind : std::uint8_t {
  henyey_greenstein,  ///< by Medium::anisotropy
  rayleigh,           ///< 1 + c^2
  haze,               ///< 1 + 9 ((1 + c) / 2)^8
  murk,               ///< 1 + 50 ((1 + c) / 2)^32
};
inline constexpr Choice<PhaseKind> kPhases[] = {{"henyey_greenstein", PhaseKind::henyey_greenstein},
                                                {"rayleigh", PhaseKind::rayleigh},
                                                {"haze", PhaseKind::haze},
                                                {"murk", PhaseKind::murk}};

inline constexpr std::uint32_t kMostMediumSteps = 1000;

/// Light that a medium takes by a power of the way through it.
struct MediumFade {
  double distance = 0;  ///< the way on which half of the light that is lost at all is; 0: none
  double power = 1;
  Color color{0, 0, 0};  ///< what is left on long ways
  bool operator==(const MediumFade&) const = default;

  static constexpr const char* kMap = "a fade of a medium";
  void describe(auto& p) {
    p.required("distance", distance, kPositiveLength, "the way on which half of what is lost at all is lost");
    p.field("power", power, Range{0, 1000, true}, "of the way");
    p.field("color", color, "what is left on long ways");
  }
};

/// What fills a part of space. Coefficients are per unit length, at least 0 and finite.
struct Medium {
  std::string name;
  Color absorption{0, 0, 0};  ///< fraction of light that is absorbed
  Color scattering{0, 0, 0};  ///< fraction of light that is scattered
  Color emission{0, 0, 0};    ///< radiance that is given off
  /// Mean cosine of the angle of scattering: above 0 forward, below 0 backward; |anisotropy| <=
  /// kMostAnisotropy.
  float anisotropy = 0;
  /// Densities that multiply absorption, scattering and emission; null: 1 everywhere. Outside of the grid
  /// there is nothing.
  std::shared_ptr<const DensityGrid> grid;
  Affine grid_place;  ///< maps the unit cube, which the grid fills, to the world; invertible

  // For Whitted's model alone:
  /// Multiplies them likewise, an index into Scene::textures: a pattern, of the place that grid_place maps to
  /// the world.
  std::uint32_t density_texture = 0xffffffff;
  PhaseKind phase = PhaseKind::henyey_greenstein;
  double extinction = 1;     ///< the part of what is scattered that light loses, >= 0
  std::uint32_t steps = 32;  ///< places on a way where a medium is asked, [1, kMostMediumSteps]
  /// What passes a way of length d is c + (1 - c) / (1 + (d / distance)^power) less; a distance of 0: not so.
  MediumFade fade{};

  /// Whether it is not the same everywhere.
  bool varies() const { return grid != nullptr || density_texture != 0xffffffff; }
};

}  // namespace oktett
