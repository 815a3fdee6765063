#include "io/mesh/recentre.h"

#include <algorithm>
#include <cmath>

#include "core/box.h"

namespace oktett {
namespace {

/// How many times their extent positions may lie away from the origin.
constexpr double kFar = 128;

double extent_of(const Box& box) { return max_component(Vec3d(box.hi) - Vec3d(box.lo)); }

double distance_of(const Box& box) {
  double most = 0;
  for (int k = 0; k < 3; ++k)
    most =
        std::max({most, std::abs(static_cast<double>(box.lo[k])), std::abs(static_cast<double>(box.hi[k]))});
  return most;
}

}  // namespace

std::optional<Vec3d> far_centre(std::span<const Vec3f> positions, bool exact) {
  if (positions.size() < 3) return std::nullopt;
  // A few tell of nearly all meshes that they are not far: the extent of all is no less.
  Box some;
  for (std::size_t i = 0; i < 16; ++i) some.grow(positions[i * (positions.size() - 1) / 15]);
  if (distance_of(some) <= extent_of(some) * (kFar - 1)) return std::nullopt;
  Box all;
  for (const Vec3f& p : positions) all.grow(p);
  const double extent = extent_of(all);
  if (!(extent > 0) || distance_of(all) <= extent * kFar) return std::nullopt;
  const double step = std::exp2(std::ceil(std::log2(extent)));
  Vec3d centre = (Vec3d(all.lo) + Vec3d(all.hi)) / 2.0;
  for (int k = 0; k < 3; ++k)
    centre[k] = exact && std::abs(centre[k]) < 4 * step ? 0 : std::round(centre[k] / step) * step;
  return centre;
}

void take_off(const Vec3d& centre, TriangleMesh& mesh) {
  for (Vec3f& p : mesh.positions) p = Vec3f(Vec3d(p) - centre);
  mesh.origin = mesh.origin + centre;
}

}  // namespace oktett
