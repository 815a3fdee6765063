#pragma once
/// \file Height fields and rays for their tests.

#include <algorithm>
#include <memory>
#include <vector>

#include "accel/accel.h"
#include "core/random.h"
#include "kernels/heights/height_grid.h"
#include "tests/support/limits.h"

namespace oktett::height_field_cases {

using Interpolation = HeightInterpolation;
inline constexpr Interpolation kAll[] = {Interpolation::nearest, Interpolation::triangles,
                                         Interpolation::bilinear};
inline constexpr HeightWalk kWalks[] = {HeightWalk::pyramid, HeightWalk::cells, HeightWalk::spans};

/// One column per unit of x and one row per unit of z, the first at -(samples - 1) / 2; heights as they are.
inline HeightFieldShape height_field(std::uint32_t columns, std::uint32_t rows,
                                     const std::vector<float>& heights, Interpolation interpolation) {
  HeightFieldShape s;
  Column<float> column(heights.size());
  std::copy(heights.begin(), heights.end(), column.begin());
  s.grid = HeightGrid::from_floats(columns, rows, std::move(column), interpolation);
  s.size = {columns - 1.0, 1, rows - 1.0};
  return s;
}

inline HeightFieldShape rough(std::uint32_t columns, std::uint32_t rows, Interpolation interpolation,
                              float height = 3) {
  std::vector<float> heights;
  for (std::uint32_t i = 0; i < columns * rows; ++i) heights.push_back(height * random_float(11, columns, i));
  return height_field(columns, rows, heights, interpolation);
}

inline HeightFieldShape solid(HeightFieldShape s, double base) {
  s.open = false, s.base = base;
  return s;
}

inline std::shared_ptr<const Accel> accel_of(const HeightFieldShape& s, const Affine& to_world = {}) {
  return build_accel({{ExactShape{s}, to_world}});
}

/// In a box about the y axis that stands at y = 0.
inline Vec3f random_point(std::uint32_t key, const Vec3f& half) {
  return {half.x * (2 * random_float(5, key, 0) - 1), half.y * random_float(5, key, 1),
          half.z * (2 * random_float(5, key, 2) - 1)};
}

/// Upright ones, and along lines of the grid, diagonals and from corner to corner.
inline std::vector<Ray> hostile_rays(const HeightFieldShape& s) {
  const auto columns = static_cast<int>(s.grid->columns()), rows = static_cast<int>(s.grid->rows());
  std::vector<Ray> rays;
  const auto x = [&](double i) { return static_cast<float>(i - (columns - 1) / 2.0); };
  const auto z = [&](double j) { return static_cast<float>(j - (rows - 1) / 2.0); };
  const auto add = [&](const Vec3f& from, const Vec3f& d) { rays.push_back({from, 0, d, kInf}); };
  // Upright, along grid lines, along diagonals, from corner to corner; all of them through samples.
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) {
      add({x(i), 50, z(j)}, {0, -1, 0});
      add({x(i), -50, z(j)}, {0, 1e-3f, 0});
      add({x(i + 0.5), 50, z(j)}, {0, -7, 0});
      const Vec3f low{x(i), -4, z(j)};
      for (const Vec3f& d :
           {Vec3f{1, 1, 0}, Vec3f{-1, 1, 0}, Vec3f{0, 1, 1}, Vec3f{0, 1, -1}, Vec3f{1, 1, 1}, Vec3f{-1, 1, 1},
            Vec3f{1, 1, -1}, Vec3f{-1, 1, -1}, Vec3f{2, 1, 1}, Vec3f{1, 2, -3}})
        add(low - d * 8.0f, d), add(low + d * 16.0f, -d);
    }
  for (int i = -1; i <= columns; ++i) {
    add({x(i), 1, -100}, {0, 0, 1});
    add({x(i), 1, 100}, {0, 1e-4f, -1});
    add({x(i), 2, -100}, {1e-30f, 1e-30f, 1});
    add({x(0) - 100, 2, z(i)}, {1, -1e-3f, 0});
    add({x(0) - 100, 2, z(i)}, {1, -1e-3f, 1e-38f});
  }
  return rays;
}

}  // namespace oktett::height_field_cases
