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
