#include "io/image/metadata.h"

#include <cmath>
#include <numbers>

#include "core/precise_math.h"

namespace oktett {
namespace {

using Matrix4d = std::array<std::array<double, 4>, 4>;

Matrix4d multiply(const Matrix4d& a, const Matrix4d& b) {
  Matrix4d product{};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) product[i][j] += a[i][k] * b[k][j];
  return product;
}

Matrix4d world_to_camera(const Camera& camera) {
  const Vec3d forward = normalize(camera.at - camera.from);
  Vec3d right = cross(forward, camera.up);
  Vec3d up;
  if (dot(right, right) > 0) {
    right = normalize(right);
    up = cross(right, forward);
  } else {
    make_basis(forward, right, up);
  }
  Matrix4d m{};
  for (int axis = 0; axis < 3; ++axis) {
    m[axis] = {right[axis], up[axis], forward[axis], 0};
  }
  m[3] = {-dot(camera.from, right), -dot(camera.from, up), -dot(camera.from, forward), 1};
  return m;
}

Matrix4d camera_to_ndc(const Camera& camera, double aspect) {
  const bool perspective = camera.projection == Projection::perspective;
  const double half_height =
      perspective ? precise::tan(camera.fov * std::numbers::pi / 360) : 0.5 * camera.height;
  const double half_width = half_height * aspect;
  Matrix4d m{};
  m[0][0] = 0.5 / half_width;
  m[1][1] = -0.5 / half_height;
  // The centre (1/2, 1/2) is added after division by w, so in perspective it enters multiplied by the depth.
  const int depth_row = perspective ? 2 : 3;
  m[depth_row][0] = m[depth_row][1] = 0.5;
  m[depth_row][3] = 1;
  m[2][2] = 1;
  m[3][2] = perspective ? -1 : 0;
  return m;
}

bool is_finite(const Matrix4d& m) {
  for (const auto& row : m)
    for (const double v : row)
      if (!std::isfinite(v)) return false;
  return true;
}

Matrix4 rounded(const Matrix4d& m) {
  Matrix4 result{};
  for (int i = 0; i < 16; ++i) result[i] = static_cast<float>(m[i / 4][i % 4]);
  return result;
}

}  // namespace

std::optional<CameraMatrices> camera_matrices(const Camera& camera, std::uint32_t width,
                                              std::uint32_t height) {
  if (width == 0 || height == 0) return std::nullopt;
  const Matrix4d to_camera = world_to_camera(camera);
  const Matrix4d to_ndc =
      multiply(to_camera, camera_to_ndc(camera, static_cast<double>(width) / static_cast<double>(height)));
  if (!is_finite(to_camera) || !is_finite(to_ndc)) return std::nullopt;
  return CameraMatrices{rounded(to_camera), rounded(to_ndc)};
}

}  // namespace oktett
