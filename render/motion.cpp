#include "render/motion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/math.h"

namespace oktett {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

struct Quaternion {
  double w = 1, x = 0, y = 0, z = 0;
};

/// linear part = rotation * stretch, where the stretch is symmetric. For a mirror the stretch is negative.
struct Parts {
  Vec3d translation;
  Quaternion rotation;
  Matrix stretch{};
};

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) c[i][j] += a[i][k] * b[k][j];
  return c;
}

Matrix transposed(const Matrix& a) {
  Matrix t;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) t[i][j] = a[j][i];
  return t;
}

/// The transposed inverse times the determinant.
Matrix cofactors(const Matrix& a) {
  Matrix c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      c[i][j] = a[i1][j1] * a[i2][j2] - a[i1][j2] * a[i2][j1];
    }
  return c;
}

double determinant(const Matrix& a, const Matrix& c) {
  return a[0][0] * c[0][0] + a[0][1] * c[0][1] + a[0][2] * c[0][2];
}

double greatest_entry(const Matrix& a) {
  double greatest = 0;
  for (const auto& row : a)
    for (const double v : row) greatest = std::max(greatest, std::abs(v));
  return greatest;
}

/// The orthogonal matrix nearest to `a`, by Newton's iteration q = (q + q^-T) / 2 (Higham 1986), which halves
/// large singular values in each step and then converges quadratically.
Matrix orthogonal_part(Matrix q) {
  constexpr int kMostSteps = 200;
  const double size = greatest_entry(q);
  for (auto& row : q)
    for (double& v : row) v /= size;
  for (int step = 0; step < kMostSteps; ++step) {
    const Matrix c = cofactors(q);
    const double det = determinant(q, c);
    double change = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const double next = 0.5 * (q[i][j] + c[i][j] / det);
        change = std::max(change, std::abs(next - q[i][j]));
        q[i][j] = next;
      }
    if (change < 1e-15) break;
  }
  return q;
}

/// Of a rotation matrix (Shepperd 1978).
Quaternion quaternion(const Matrix& m) {
  const double trace = m[0][0] + m[1][1] + m[2][2];
  const double four[4] = {1 + trace, 1 + 2 * m[0][0] - trace, 1 + 2 * m[1][1] - trace,
                          1 + 2 * m[2][2] - trace};
  const auto greatest = std::max_element(four, four + 4) - four;
  const double s = std::sqrt(four[greatest]), r = 0.5 / s;
  const double wx = (m[2][1] - m[1][2]) * r, wy = (m[0][2] - m[2][0]) * r, wz = (m[1][0] - m[0][1]) * r;
  const double xy = (m[0][1] + m[1][0]) * r, xz = (m[0][2] + m[2][0]) * r, yz = (m[1][2] + m[2][1]) * r;
  if (greatest == 0) return {s / 2, wx, wy, wz};
  if (greatest == 1) return {wx, s / 2, xy, xz};
  if (greatest == 2) return {wy, xy, s / 2, yz};
  return {wz, xz, yz, s / 2};
}

Matrix matrix(const Quaternion& q) {
  return {{{1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - q.w * q.z), 2 * (q.x * q.z + q.w * q.y)},
           {2 * (q.x * q.y + q.w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z - q.w * q.x)},
           {2 * (q.x * q.z - q.w * q.y), 2 * (q.y * q.z + q.w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y)}}};
}

/// From a to b by the shortest arc.
Quaternion turned(const Quaternion& a, Quaternion b, double part) {
  double cosine = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
  if (cosine < 0) b = {-b.w, -b.x, -b.y, -b.z}, cosine = -cosine;
  double of_a = 1 - part, of_b = part;
  // Nearer together the arc is as good as straight.
  if (cosine < 1 - 1e-12) {
    const double angle = portable::acos(cosine), sine = portable::sin(angle);
    of_a = portable::sin(of_a * angle) / sine, of_b = portable::sin(of_b * angle) / sine;
  }
  const Quaternion q{of_a * a.w + of_b * b.w, of_a * a.x + of_b * b.x, of_a * a.y + of_b * b.y,
                     of_a * a.z + of_b * b.z};
  const double size = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w / size, q.x / size, q.y / size, q.z / size};
}

Parts parts_of(const Affine& a) {
  Parts p;
  Matrix linear;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) linear[i][j] = a.m[i][j];
  p.translation = {a.m[0][3], a.m[1][3], a.m[2][3]};
  Matrix q = orthogonal_part(linear);
  if (a.determinant() < 0)
    for (auto& row : q)
      for (double& v : row) v = -v;
  p.rotation = quaternion(q);
  p.stretch = product(transposed(q), linear);
  return p;
}

Affine between(const Affine& from, const Affine& to, double part) {
  const Parts a = parts_of(from), b = parts_of(to);
  Matrix stretch;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) stretch[i][j] = (1 - part) * a.stretch[i][j] + part * b.stretch[i][j];
  const Matrix linear = product(matrix(turned(a.rotation, b.rotation, part)), stretch);
  const Vec3d translation = a.translation * (1 - part) + b.translation * part;
  Affine result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result.m[i][j] = linear[i][j];
    result.m[i][3] = translation[i];
  }
  return result;
}

Affine factor_at(const std::vector<MotionKey>& keys, double time) {
  const auto next =
      std::find_if(keys.begin(), keys.end(), [&](const MotionKey& k) { return k.time >= time; });
  if (next == keys.end()) return keys.back().transform;
  if (next == keys.begin() || next->time == time) return next->transform;
  const MotionKey& last = *(next - 1);
  return between(last.transform, next->transform, (time - last.time) / (next->time - last.time));
}

}  // namespace

Affine Motion::at(double time) const {
  Affine all;
  bool first = true;
  for (const std::vector<MotionKey>& keys : factors) {
    all = first ? factor_at(keys, time) : all * factor_at(keys, time);
    first = false;
  }
  return all;
}

bool Motion::moves() const {
  return std::any_of(factors.begin(), factors.end(), [](const auto& keys) { return keys.size() > 1; });
}

}  // namespace oktett
