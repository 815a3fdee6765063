#pragma once
/// \file Height fields of functions and pigments. Within io/ only.

#include "io/pov/translate/meshes.h"

namespace oktett::pov {

/// The triangles over the unit square of x and z whose heights a function has at columns x rows places, 2 to
/// a side at least; of a pigment the grey of its colours. Null if the function has no value somewhere, or if
/// nobody can be asked.
struct HeightForm {
  std::uint32_t columns = 2, rows = 2;
  bool smooth = false;  ///< with normals
  bool solid = false;   ///< with sides, and a bottom a little below 0
  double water = 0;     ///< if it is not solid: what is lower is left out
};
std::shared_ptr<const TriangleMesh> height_mesh(Context& context, const Function& function,
                                                const HeightForm& form);

}  // namespace oktett::pov
