#include "io/image/metadata.h"

#include <cmath>
#include <numbers>

#include "core/precise_math.h"
#include "render/camera.h"

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

/// The columns of both matrices of a camera that states its view by vectors.
struct FrameMatrices {
  Matrix4d to_camera{}, to_ndc{};

  FrameMatrices(const Camera& camera, const ViewFrame& view) {
    const bool perspective = camera.projection == Projection::perspective;
    const CameraFrame frame = camera_frame(camera, Film{});
    put(to_camera, 0, frame.right, 0, camera.from);
    put(to_camera, 1, frame.up, 0, camera.from);
    put(to_camera, 2, frame.forward, 0, camera.from);
    to_camera[3][3] = 1;
    // p - from = a right + b up + c direction, each vector times `scale`; the middle lies at c = 1.
    const double scale = perspective ? 1 / dot(frame.forward, view.direction) : 1;
    const Vec3d right = view.right * scale, up = view.up * scale;
    const Vec3d ahead = perspective ? view.direction * scale : frame.forward;
    const double volume = dot(cross(right, up), ahead);
    const Vec3d a = cross(up, ahead) / volume, b = cross(ahead, right) / volume,
                c = cross(right, up) / volume;
    const double middle = perspective ? 0 : 0.5;
    put(to_ndc, 0, perspective ? a + c * 0.5 : a, middle, camera.from);
    put(to_ndc, 1, perspective ? c * 0.5 - b : b * -1.0, middle, camera.from);
    put(to_ndc, 2, c, perspective ? -1 : 0, camera.from);
    if (perspective)
      put(to_ndc, 3, c, 0, camera.from);
    else
      to_ndc[3][3] = 1;
  }

 private:
  /// Column `k` maps p to v (p - from) + rest.
  static void put(Matrix4d& m, int k, const Vec3d& v, double rest, const Vec3d& from) {
    for (int axis = 0; axis < 3; ++axis) m[axis][k] = v[axis];
    m[3][k] = rest - dot(v, from);
  }
};

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
  if (width == 0 || height == 0 || is_curved(camera.projection)) return std::nullopt;
  if (camera.frame) {
    const FrameMatrices m(camera, *camera.frame);
    if (!is_finite(m.to_camera) || !is_finite(m.to_ndc)) return std::nullopt;
    return CameraMatrices{rounded(m.to_camera), rounded(m.to_ndc)};
  }
  const Matrix4d to_camera = world_to_camera(camera);
  const Matrix4d to_ndc =
      multiply(to_camera, camera_to_ndc(camera, static_cast<double>(width) / static_cast<double>(height)));
  if (!is_finite(to_camera) || !is_finite(to_ndc)) return std::nullopt;
  return CameraMatrices{rounded(to_camera), rounded(to_ndc)};
}

}  // namespace oktett
