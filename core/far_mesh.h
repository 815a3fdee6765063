#pragma once
/// \file Meshes that lie far from the origin, such as scans in coordinates of a map. Floats would lose their
/// details, so a centre is taken off in double precision.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "core/mesh.h"

namespace oktett {

/// A box in double precision around places that are finite. The default is empty.
struct WideBox {
  Vec3d lo{kInf, kInf, kInf}, hi{-kInf, -kInf, -kInf};

  bool empty() const { return !(lo.x <= hi.x); }
  /// Places that are not finite change nothing.
  void grow(const Vec3d& p) {
    if (is_finite(p)) lo = min(lo, p), hi = max(hi, p);
  }
  /// The longest edge.
  double extent() const { return empty() ? 0 : max_component(hi - lo); }
  /// The greatest magnitude of a coordinate.
  double distance() const { return empty() ? 0 : std::max(max_component(abs(lo)), max_component(abs(hi))); }

 private:
  static constexpr double kInf = std::numeric_limits<double>::infinity();
};

/// How many times their extent places lie away from the origin that count as far; floats keep fewer than 16
/// bits of their differences.
inline constexpr double kFarExtents = 128;

/// Whether places that this box holds are near the origin, whatever other places are beside them.
inline bool surely_near(const WideBox& some) { return some.distance() <= some.extent() * (kFarExtents - 1); }

/// Whether what this box holds lies far from the origin.
inline bool is_far(const WideBox& box) { return box.distance() > box.extent() * kFarExtents; }

/// The box of a few of the positions. Of nearly all meshes these tell that they are not far: the extent of
/// all is no less.
template <class Positions>
WideBox box_of_some(const Positions& positions) {
  WideBox some;
  for (std::size_t i = 0; i < 16 && !positions.empty(); ++i)
    some.grow(Vec3d(positions[i * (positions.size() - 1) / 15]));
  return some;
}

/// A centre to take off places, all in `box`, that lie far from the origin; nothing for others. It is a
/// multiple of a power of two that is at least the extent, so the differences are floats if the places are.
/// Each place may be off by `rounding` of its distance. `exact`: nothing is taken off along axes that are not
/// far, so that the differences of floats are floats there, too.
std::optional<Vec3d> far_centre(const WideBox& box, double rounding, bool exact);

/// The same for the positions of a mesh. `exact`: positions are those of the file or array; else they were
/// rounded.
std::optional<Vec3d> far_centre(std::span<const Vec3f> positions, bool exact);
/// The same for positions that are not rounded.
std::optional<Vec3d> far_centre(std::span<const Vec3d> positions);

/// Takes a centre off positions that are exact as floats; so are the differences then.
void take_off(const Vec3d& centre, TriangleMesh& mesh);

/// Sets the positions of a mesh, which has none: rounded, and less a centre if they lie far from the origin.
void set_positions(std::span<const Vec3d> positions, TriangleMesh& mesh);

}  // namespace oktett
