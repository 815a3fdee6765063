#pragma once
/// \file Media as data: fog, smoke, liquids, coloured glass.

#include <memory>
#include <string>

#include "core/transform.h"
#include "core/vec3.h"
#include "render/medium/density_grid.h"

namespace oktett {

/// Greatest magnitude of Medium::anisotropy.
inline constexpr float kMostAnisotropy = 0.999f;

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
};

}  // namespace oktett
