#pragma once
/// \file Winding numbers of what a structure shows: sums over trees of surfaces, exact solid angles where
/// their bounds do not suffice.

#include <memory>
#include <vector>

#include "accel/accel_data.h"
#include "accel/code.h"
#include "accel/winding/winding_tree.h"

namespace oktett {

/// An instance, as a part of the structure that shows it.
struct WindingPart {
  const Accel* child;
  Affine to_child, to_outer;
};

/// The surfaces of a structure's meshes, and of its instances.
class WindingField {
 public:
  explicit WindingField(const Accel& accel);

  WindingTree meshes;  ///< over all triangles of the structure itself
  WindingTree shown;   ///< over `parts`
  std::vector<WindingPart> parts;
  WindingMoments whole;       ///< of both
  bool shows_others = false;  ///< what is shown is not only meshes
  /// Triangles from one corner of the holes to all their edges: with these, turned round, the surfaces are
  /// closed. So the winding number is that of the caps and a whole number. Only if `is_capped`: if there are
  /// not too many, and all parts are closed.
  std::vector<WindingTriangle> caps;
  bool is_capped = false;
  bool empty() const { return meshes.empty() && shown.empty(); }
};

/// That of a structure. The first call makes it, with all threads; it is kept with the structure.
const WindingField& winding_field(const Accel& accel);

/// How often the surfaces wind around a point, which is finite, in turns; off by at most `error`.
double winding_within(const Accel& accel, const Vec3f& point, double error, const PointCode& code);
/// Whether they do so by more than half a turn, in either sense. Certain, but for what solid angles in
/// extended precision cannot tell, which is no.
bool winds_around(const Accel& accel, const Vec3f& point, const PointCode& code);

}  // namespace oktett
