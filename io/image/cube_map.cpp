#include "io/image/cube_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace oktett {
namespace {

/// A place on a cube map: the face, and pixels from its upper left one's centre.
struct CubePlace {
  std::size_t face;
  double x, y;
};

/// Where the direction `d` meets a cube whose faces have `size` pixels along a side. Their outer pixels lie
/// on the edges.
CubePlace cube_place(const Vec3d& d, std::uint32_t size) {
  const Vec3d a = abs(d);
  const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
  const bool negative = d[axis] < 0;
  const double last = size - 1.0;
  const auto along = [&](int k) { return (d[k] / a[axis] + 1) / 2 * last; };
  switch (axis) {
    case 0:
      return {negative ? 1u : 0u, negative ? last - along(2) : along(2), last - along(1)};
    case 1:
      return {negative ? 3u : 2u, along(0), negative ? along(2) : last - along(2)};
    default:
      return {negative ? 5u : 4u, negative ? along(0) : last - along(0), last - along(1)};
  }
}

Color cube_color(const EnvironmentPicture& cube, const Vec3d& d) {
  const std::uint32_t size = std::min(cube.width, cube.height / 6);
  const CubePlace p = cube_place(d, size);
  const auto whole = [&](double x) { return static_cast<std::uint32_t>(std::clamp(x, 0.0, size - 1.0)); };
  const std::uint32_t x = whole(p.x), y = whole(p.y), x1 = std::min(x + 1, size - 1),
                      y1 = std::min(y + 1, size - 1);
  const auto fx = static_cast<float>(p.x - x), fy = static_cast<float>(p.y - y);
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    return cube.pixels[(p.face * size + j) * cube.width + i];
  };
  const Color above = at(x, y) * (1 - fx) + at(x1, y) * fx, below = at(x, y1) * (1 - fx) + at(x1, y1) * fx;
  return above * (1 - fy) + below * fy;
}

}  // namespace

EnvironmentPicture unfolded_cube(const EnvironmentPicture& cube) {
  const std::uint32_t size = std::min(cube.width, cube.height / 6);
  EnvironmentPicture picture;
  picture.width = 4 * size, picture.height = 2 * size;
  picture.pixels.resize(std::size_t{picture.width} * picture.height);
  tbb::parallel_for(std::uint32_t{0}, picture.height, [&](std::uint32_t y) {
    for (std::uint32_t x = 0; x < picture.width; ++x) {
      const double u = (x + 0.5) / picture.width, v = (y + 0.5) / picture.height;
      picture.pixels[std::size_t{y} * picture.width + x] =
          cube_color(cube, Vec3d(environment_direction(u, v)));
    }
  });
  return picture;
}

}  // namespace oktett
