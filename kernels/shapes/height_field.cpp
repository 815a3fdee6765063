#include "kernels/shapes/height_field.h"

#include <algorithm>
#include <cmath>

#include "kernels/shapes/height_cell.h"

namespace oktett {

namespace {

/// The cell of [0, samples - 1] that x is in, and where in it.
struct Place {
  std::uint32_t cell;
  double share;

  Place(double x, std::uint32_t samples) {
    const double last = static_cast<double>(samples) - 2;
    const double whole = x >= 1 ? std::min(std::floor(x), last) : 0;
    cell = static_cast<std::uint32_t>(whole);
    share = std::clamp(x - whole, 0.0, 1.0);
  }
};

struct Patch {
  double height, by_x, by_z;  ///< and its derivatives, all of samples as stored, by column and row
};

Patch patch_at(const HeightGrid& grid, double x, double z) {
  const Place a(x, grid.columns()), b(z, grid.rows());
  const CellCorners c(grid, a.cell, b.cell);
  const double u = a.share, v = b.share;
  switch (grid.interpolation()) {
    case HeightInterpolation::nearest:
      return {c.mean(), 0, 0};
    case HeightInterpolation::triangles:
      if (u + v <= 1)
        return {c.h00 + (u * (c.h10 - c.h00) + v * (c.h01 - c.h00)), c.h10 - c.h00, c.h01 - c.h00};
      return {c.h11 + ((1 - u) * (c.h01 - c.h11) + (1 - v) * (c.h10 - c.h11)), c.h11 - c.h01, c.h11 - c.h10};
    case HeightInterpolation::bilinear:
      break;
  }
  const double low = c.h00 + u * (c.h10 - c.h00), high = c.h01 + u * (c.h11 - c.h01);
  return {low + v * (high - low), (c.h10 - c.h00) + v * ((c.h11 - c.h01) - (c.h10 - c.h00)), high - low};
}

}  // namespace

std::size_t HeightFieldPool::bytes() const {
  std::size_t sum = ExactPool<HeightFieldElement>::bytes();
  for (const HeightFieldElement& e : elements) sum += e.grid->bytes();
  return sum;
}

void HeightField::add(Pool& pool, const ExactShape& shape, const Affine& to_world, std::uint32_t item) {
  const auto& s = std::get<HeightFieldShape>(shape.form);
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
  add_element(pool, e, to_world * own, item, shape.normals);
  add_cell(pool, e.lo, e.hi);
}

bool HeightField::below_rim(const HeightGrid& grid, int face, double x, double y, double z) {
  // Edges are straight, but for steps, which end upright there.
  if (face <= 2) x = face == 1 ? 0 : static_cast<double>(grid.columns()) - 1;
  if (face >= 5) z = face == 5 ? 0 : static_cast<double>(grid.rows()) - 1;
  return y < patch_at(grid, x, z).height;
}

void HeightField::slope_of(const HeightFieldElement& e, int part, double x, double y, double z, double& value,
                           double& gx, double& gy, double& gz) {
  gx = gy = gz = 0;
  if (part >= 1 && part <= 6) {
    value = face_value(e.lo, e.hi, part, {x, y, z});
    const Vec3d g = face_gradient(part);
    gx = g.x, gy = g.y, gz = g.z;
    return;
  }
  const Vec3d &scale = e.frame.scale, &shift = e.frame.shift;
  if (part == kWallLowX || part == kWallHighX || part == kWallLowZ || part == kWallHighZ) {
    const bool along_x = part <= kWallHighX, low = part == kWallLowX || part == kWallLowZ;
    const int k = along_x ? 0 : 2;
    const double at = along_x ? x : z,
                 wall = (std::nearbyint(at * scale[k] + shift[k]) - shift[k]) / scale[k];
    value = low ? wall - at : at - wall;
    (along_x ? gx : gz) = low ? -1 : 1;
    return;
  }
  const Patch patch = patch_at(*e.grid, x * scale.x + shift.x, z * scale.z + shift.z);
  value = y - (patch.height - shift.y) / scale.y;
  gx = -patch.by_x * (scale.x / scale.y), gy = 1, gz = -patch.by_z * (scale.z / scale.y);
}

double HeightField::value(const Pool& pool, std::size_t i, int part, const Vec3d& p) {
  return slope_at<HeightField>(pool, i, part, p).value;
}

Vec3d HeightField::gradient(const Pool& pool, std::size_t i, int part, const Vec3d& p) {
  return slope_at<HeightField>(pool, i, part, p).gradient;
}

bool HeightField::inside(const Pool& pool, std::size_t i, const Vec3d& p) {
  const HeightFieldElement& e = pool.elements[i];
  if (!e.solid) return false;
  for (int k = 0; k < 3; ++k)
    if (!(e.lo[k] <= p[k] && p[k] <= e.hi[k])) return false;
  return value(pool, i, 0, p) < 0;
}

void HeightField::uv(const Pool& pool, std::size_t i, int part, const Vec3d& p, Surface& s) {
  const HeightFieldElement& e = pool.elements[i];
  const double width = e.hi.x - e.lo.x, depth = e.hi.z - e.lo.z;
  s.uv = {static_cast<float>((p.x - e.lo.x) / width), static_cast<float>((e.hi.z - p.z) / depth)};
  const Vec3d g = part == 0 ? gradient(pool, i, part, p) : Vec3d{0, 1, 0};
  s.tangent = Vec3f(Vec3d{width, -g.x * width, 0});
}

}  // namespace oktett
