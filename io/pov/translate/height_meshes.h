#pragma once
/// \file Height fields that become meshes: of functions, of pigments and of images in colour. Within io/
/// only.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/pov/translate/meshes.h"

namespace oktett::pov {

/// Heights at columns x rows places of the unit square of x and z, by rows of ascending z; 2 to a side at
/// least.
struct Heights {
  std::uint32_t columns = 2, rows = 2;
  std::vector<double> y;
};

/// The values of a function; of a pigment the grey of its colours. Nothing if it has no value somewhere, or
/// if nobody can be asked.
std::optional<Heights> heights_of_function(Context& context, const Function& function, std::uint32_t columns,
                                           std::uint32_t rows);

/// The heights that an image in colour means: 256 times red and green of 8-bit images, of others the grey of
/// their colours. Nothing for grey images, and for those that are too large. Throws Error of kind io if it
/// cannot be read.
std::optional<Heights> heights_of_colors(const std::string& file);

/// What becomes of heights: triangles, two to a cell.
struct HeightForm {
  bool smooth = false;  ///< with normals
  bool solid = false;   ///< with sides, and a bottom a little below 0
  double water = 0;     ///< if it is not solid: what is lower is left out
};
std::shared_ptr<const TriangleMesh> height_mesh(const Heights& heights, const HeightForm& form);

}  // namespace oktett::pov
