#include "kernels/heights/height_field.h"

#include <algorithm>
#include <cmath>

namespace oktett {

std::size_t HeightFieldPool::bytes() const {
  std::size_t sum = ExactPool<HeightFieldElement>::bytes();
  for (const HeightFieldElement& e : elements) sum += e.grid->bytes();
  return sum;
}

void HeightField::add(Pool& pool, const HeightFieldShape& s, const ExactPlace& place) {
  if (!s.grid || s.grid->columns() < 2 || s.grid->rows() < 2) return;
  const HeightGrid& grid = *s.grid;
  for (int k = 0; k < 3; ++k)
    if (!(s.size[k] > 0) || !std::isfinite(s.size[k])) return;
  const double unit = s.size.y * grid.unit();  // a sample as stored, in the space of the description
  const double least = grid.least() * unit, greatest = grid.greatest() * unit;
  if (!std::isfinite(least) || !std::isfinite(greatest) || !(unit > 0)) return;
  if (!s.open && !(s.base < least)) return;
  const double floor = s.open ? least : s.base, middle = floor + (greatest - floor) * 0.5;
  int shift = 0;
  std::frexp(std::max({s.size.x, s.size.z, greatest - floor}) * 0.5, &shift);
  const double size = std::ldexp(1.0, shift);

  HeightFieldElement e;
  e.keep = s.grid, e.grid = s.grid.get(), e.walk = s.walk, e.solid = !s.open;
  e.smooth = s.smooth && grid.interpolation() != HeightInterpolation::nearest;
  const double half_x = s.size.x * 0.5 / size, half_z = s.size.z * 0.5 / size;
  const auto cells = [](std::uint32_t samples) { return static_cast<double>(samples) - 1; };
  e.frame.scale = {cells(grid.columns()) / (2 * half_x), size / unit, cells(grid.rows()) / (2 * half_z)};
  e.frame.shift = {cells(grid.columns()) * 0.5, middle / unit, cells(grid.rows()) * 0.5};
  // Room that rounding cannot cross, also about a level field.
  const double room = 0x1p-30 + 0x1p-20 * (greatest - least) / size + 0x1p-40 * std::abs(middle) / size;
  e.margin = room * e.frame.scale.y;
  const auto own_height = [&](double y) { return (y - middle) / size; };
  e.lo = {-half_x, s.open ? own_height(least) - 2 * room : own_height(s.base), -half_z};
  e.hi = {half_x, own_height(greatest) + 2 * room, half_z};
  const Affine own = Affine::translation({0, middle, 0}) * Affine::scaling({size, size, size});
  add_element(pool, e, place.to_world * own, place);
  add_cell(pool, e.lo, e.hi);
}

bool height::below_rim(const HeightGrid& grid, int face, double x, double y, double z) {
  // Edges are straight, but for steps, which end upright there.
  if (face <= 2) x = face == 1 ? 0 : static_cast<double>(grid.columns()) - 1;
  if (face >= 5) z = face == 5 ? 0 : static_cast<double>(grid.rows()) - 1;
  using D = Simd<double, 1, ScalarIsa>;
  return y < only_lane(HeightPatch<D>(grid, D(x), D(z)).height);
}

Vec3d HeightField::smooth_gradient(const Pool& pool, std::size_t i, int part, const Vec3d& p) {
  if (part > 0) return slope_at<HeightField>(pool, i, part, p).gradient;
  const HeightFieldElement& e = pool.elements[i];
  const HeightGrid& grid = *e.grid;
  // By column and row; on the border what rises from or to the only neighbour.
  const auto rises = [&](std::uint32_t x, std::uint32_t z) {
    const std::uint32_t x0 = x > 0 ? x - 1 : x, x1 = x + 1 < grid.columns() ? x + 1 : x;
    const std::uint32_t z0 = z > 0 ? z - 1 : z, z1 = z + 1 < grid.rows() ? z + 1 : z;
    return Vec3d{(grid.at(x1, z) - grid.at(x0, z)) / (x1 - x0), 0,
                 (grid.at(x, z1) - grid.at(x, z0)) / (z1 - z0)};
  };
  const auto place = [](double at, std::uint32_t samples, double& share) {
    const double cell = std::clamp(std::floor(at), 0.0, static_cast<double>(samples) - 2);
    share = std::clamp(at - cell, 0.0, 1.0);
    return static_cast<std::uint32_t>(cell);
  };
  double u, v;
  const std::uint32_t x = place(p.x * e.frame.scale.x + e.frame.shift.x, grid.columns(), u);
  const std::uint32_t z = place(p.z * e.frame.scale.z + e.frame.shift.z, grid.rows(), v);
  const Vec3d near = rises(x, z) * (1 - u) + rises(x + 1, z) * u,
              far = rises(x, z + 1) * (1 - u) + rises(x + 1, z + 1) * u, mean = near * (1 - v) + far * v;
  const Vec3d& scale = e.frame.scale;
  return {-mean.x * (scale.x / scale.y), 1, -mean.z * (scale.z / scale.y)};
}

bool HeightField::inside(const Pool& pool, std::size_t i, const Vec3d& p) {
  const HeightFieldElement& e = pool.elements[i];
  if (!e.solid) return false;
  for (int k = 0; k < 3; ++k)
    if (!(e.lo[k] <= p[k] && p[k] <= e.hi[k])) return false;
  return slope_at<HeightField>(pool, i, 0, p).value < 0;
}

SurfaceUv HeightField::uv(const Pool& pool, std::size_t i, int, const Vec3d& p) {
  const HeightFieldElement& e = pool.elements[i];
  return {(component(p, 0) - e.lo.x) / (e.hi.x - e.lo.x),
          (component(p, 2) * -1 + e.hi.z) / (e.hi.z - e.lo.z)};
}

}  // namespace oktett
