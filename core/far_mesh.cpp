#include "core/far_mesh.h"

namespace oktett {

std::optional<Vec3d> far_centre(const WideBox& box, double rounding, bool exact) {
  const double distance = box.distance(), extent = std::max(box.extent(), distance * rounding);
  if (!(extent > 0) || distance <= extent * kFarExtents) return std::nullopt;
  const double step = std::exp2(std::ceil(std::log2(extent)));
  Vec3d centre = box.lo / 2.0 + box.hi / 2.0;
  for (int k = 0; k < 3; ++k)
    centre[k] = exact && std::abs(centre[k]) < 4 * step ? 0 : std::round(centre[k] / step) * step;
  return centre;
}

template <class T>
static std::optional<Vec3d> centre_of(std::span<const Vec3<T>> positions, double rounding, bool exact) {
  if (positions.size() < 3) return std::nullopt;
  if (const WideBox some = box_of_some(positions); surely_near(some) && some.extent() > 0)
    return std::nullopt;
  WideBox all;
  for (const Vec3<T>& p : positions) all.grow(Vec3d(p));
  return far_centre(all, rounding, exact);
}

std::optional<Vec3d> far_centre(std::span<const Vec3f> positions, bool exact) {
  // Two coordinates that were rounded differ by an ulp more or less than before.
  return centre_of(positions, exact ? 0 : 0x1p-23, exact);
}

std::optional<Vec3d> far_centre(std::span<const Vec3d> positions) {
  return centre_of(positions, 0x1p-52, false);
}

void take_off(const Vec3d& centre, TriangleMesh& mesh) {
  for (Vec3f& p : mesh.positions) p = Vec3f(Vec3d(p) - centre);
  mesh.origin = mesh.origin + centre;
}

void set_positions(std::span<const Vec3d> positions, TriangleMesh& mesh) {
  mesh.origin = far_centre(positions).value_or(Vec3d{});
  mesh.positions.resize_uninitialized(positions.size());
  std::ranges::transform(positions, mesh.positions.begin(),
                         [&](const Vec3d& p) { return Vec3f(p - mesh.origin); });
}

}  // namespace oktett
