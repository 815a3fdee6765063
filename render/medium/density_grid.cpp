#include "render/medium/density_grid.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace oktett {

DensityGrid::DensityGrid(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz, Column<float> values)
    : size_{nx, ny, nz}, values_(std::move(values)) {
  for (std::uint32_t& side : size_) side = std::clamp(side, 2u, kMostDensitySide);
  const std::size_t count = std::size_t{size_[0]} * size_[1] * size_[2];
  if (values_.size() != count) values_ = Column<float>(count, 0.0f);
  for (float& v : values_)
    if (!(v >= 0 && v <= std::numeric_limits<float>::max())) v = 0;
  bound_blocks();
}

void DensityGrid::bound_blocks() {
  for (int axis = 0; axis < 3; ++axis) blocks_[axis] = (static_cast<int>(size_[axis]) - 2) / kBlock + 1;
  block_most_.resize_uninitialized(static_cast<std::size_t>(blocks_[0]) * blocks_[1] * blocks_[2]);
  // A cell more on each side: a place on the border may belong to either block after rounding.
  const auto first = [](int block) { return static_cast<std::uint32_t>(std::max(0, block * kBlock - 1)); };
  const auto last = [&](int block, int axis) {
    return std::min(static_cast<std::uint32_t>((block + 1) * kBlock + 1), size_[axis] - 1);
  };
  std::size_t n = 0;
  for (int bz = 0; bz < blocks_[2]; ++bz)
    for (int by = 0; by < blocks_[1]; ++by)
      for (int bx = 0; bx < blocks_[0]; ++bx) {
        float most = 0;
        for (std::uint32_t z = first(bz); z <= last(bz, 2); ++z)
          for (std::uint32_t y = first(by); y <= last(by, 1); ++y)
            for (std::uint32_t x = first(bx); x <= last(bx, 0); ++x) most = std::max(most, value(x, y, z));
        block_most_[n++] = most;
        most_ = std::max(most_, static_cast<double>(most));
      }
}

double DensityGrid::at(const Vec3d& place) const {
  std::uint32_t cell[3];
  double part[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double most = size_[axis] - 1.0;
    if (!(place[axis] >= 0 && place[axis] <= most)) return 0;
    cell[axis] = std::min(static_cast<std::uint32_t>(place[axis]), size_[axis] - 2);
    part[axis] = place[axis] - cell[axis];
  }
  const auto along_x = [&](std::uint32_t y, std::uint32_t z) {
    const auto a = static_cast<double>(value(cell[0], y, z));
    const auto b = static_cast<double>(value(cell[0] + 1, y, z));
    return a + (b - a) * part[0];
  };
  const auto along_y = [&](std::uint32_t z) {
    const double a = along_x(cell[1], z), b = along_x(cell[1] + 1, z);
    return a + (b - a) * part[1];
  };
  const double a = along_y(cell[2]), b = along_y(cell[2] + 1);
  return a + (b - a) * part[2];
}

}  // namespace oktett
