#include "core/transform.h"

#include <cmath>
#include <numbers>

#include "core/double_double.h"
#include "core/lanes.h"
#include "core/math.h"

namespace oktett {

Affine Affine::translation(const Vec3d& t) {
  Affine a;
  for (int i = 0; i < 3; ++i) a.m[i][3] = t[i];
  return a;
}

Affine Affine::scaling(const Vec3d& s) {
  Affine a;
  for (int i = 0; i < 3; ++i) a.m[i][i] = s[i];
  return a;
}

/// Sine and cosine of an angle in degrees; exact at multiples of 90, so that quarter turns keep boxes
/// axis-aligned.
static void sin_cos_degrees(double degrees, double& s, double& c) {
  const double quarter = std::remainder(degrees, 360.0) / 90.0;
  if (quarter == std::round(quarter)) {
    const int k = static_cast<int>(quarter) & 3;
    s = k == 1 ? 1 : k == 3 ? -1 : 0;
    c = k == 0 ? 1 : k == 2 ? -1 : 0;
    return;
  }
  s = portable::sin(degrees * std::numbers::pi / 180);
  c = portable::cos(degrees * std::numbers::pi / 180);
}

static Affine rotation_about(int axis, double degrees) {
  double s, c;
  sin_cos_degrees(degrees, s, c);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  Affine a;
  a.m[u][u] = a.m[v][v] = c;
  a.m[u][v] = -s;
  a.m[v][u] = s;
  return a;
}

Affine Affine::rotation(const Vec3d& degrees) {
  return rotation_about(2, degrees.z) * rotation_about(1, degrees.y) * rotation_about(0, degrees.x);
}

Affine Affine::rotation(const Vec3d& axis, double degrees) {
  double s, c;
  sin_cos_degrees(degrees, s, c);
  const Vec3d a = normalize(axis);
  const double k = 1 - c;
  Affine r;
  r.m[0] = {c + a.x * a.x * k, a.x * a.y * k - a.z * s, a.x * a.z * k + a.y * s, 0};
  r.m[1] = {a.y * a.x * k + a.z * s, c + a.y * a.y * k, a.y * a.z * k - a.x * s, 0};
  r.m[2] = {a.z * a.x * k - a.y * s, a.z * a.y * k + a.x * s, c + a.z * a.z * k, 0};
  return r;
}

Vec3d Affine::point(const Vec3d& p) const { return map_point(*this, p); }
Vec3d Affine::vector(const Vec3d& v) const { return map_vector(*this, v); }
Vec3d Affine::normal_by_inverse(const Vec3d& n) const { return map_normal(*this, n); }

/// |M| v, with the absolute values of the entries of the linear part.
static Vec3d magnitude(const Affine& a, const Vec3d& v) {
  Vec3d sum;
  for (int k = 0; k < 3; ++k)
    sum[k] = std::abs(a.m[k][0]) * v.x + std::abs(a.m[k][1]) * v.y + std::abs(a.m[k][2]) * v.z;
  return sum;
}

Vec3d displacement(const Affine& map, const Affine& inverse, const Vec3d& reach) {
  const Vec3d offset{std::abs(map.m[0][3]), std::abs(map.m[1][3]), std::abs(map.m[2][3])};
  return magnitude(inverse, (magnitude(map, reach) + offset) * 0x1p-50);
}

/// The inverse by cofactors in double-double arithmetic.
static Affine long_inverse(const Affine& a) {
  const auto minor = [&](int i, int j) {
    const int r = (i + 1) % 3, s = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
    return two_product(a.m[r][c], a.m[s][d]) - two_product(a.m[r][d], a.m[s][c]);
  };
  DoubleDouble determinant = 0;
  for (int j = 0; j < 3; ++j) determinant = determinant + minor(0, j) * DoubleDouble(a.m[0][j]);
  Affine inverse;
  for (int i = 0; i < 3; ++i) {
    DoubleDouble shift = 0;
    for (int j = 0; j < 3; ++j) {
      const DoubleDouble entry = minor(j, i) / determinant;
      inverse.m[i][j] = entry.hi;
      shift = shift - entry * DoubleDouble(a.m[j][3]);
    }
    inverse.m[i][3] = shift.hi;
  }
  return inverse;
}

Affine Affine::inverse() const {
  const Affine quick = inverse_map<double>(*this);
  // The products of the cofactors cancel, and the inverse loses digits, where the map is flat in a direction
  // that is none of the axes: where |M^-1| |M|, with absolute values of all entries, is large.
  const double lost = max_component(magnitude(quick, magnitude(*this, {1, 1, 1})));
  return lost > 16 ? long_inverse(*this) : quick;
}

static Vec3d column(const Affine& a, int j) { return {a.m[0][j], a.m[1][j], a.m[2][j]}; }

double Affine::determinant() const {
  return dot(column(*this, 0), cross(column(*this, 1), column(*this, 2)));
}

static bool all_finite(const Affine& a) {
  for (const auto& row : a.m)
    for (double v : row)
      if (!std::isfinite(v)) return false;
  return true;
}

bool Affine::is_invertible() const { return is_invertible(inverse()); }

bool Affine::is_invertible(const Affine& known_inverse) const {
  if (!all_finite(*this)) return false;
  // The determinant divided by the lengths of the columns measures how flat the image of the unit cube is.
  const double lengths = length(column(*this, 0)) * length(column(*this, 1)) * length(column(*this, 2));
  const double det = std::abs(determinant());
  return det > 1e-14 * lengths && det > 0 && all_finite(known_inverse);
}

double Affine::uniform_scale() const {
  const double s = length(column(*this, 0));
  const double tolerance = 1e-12 * s * s;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      const double expected = i == j ? s * s : 0;
      if (!(std::abs(dot(column(*this, i), column(*this, j)) - expected) <= tolerance)) return 0;
    }
  return s;
}

Affine operator*(const Affine& a, const Affine& b) {
  Affine r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      r.m[i][j] =
          a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j] + (j == 3 ? a.m[i][3] : 0);
  return r;
}

Box transform_bounds(const Affine& map, const Box& box) {
  if (box.empty()) return {};
  Vec3d lo, hi;
  for (int i = 0; i < 3; ++i) {
    lo[i] = hi[i] = map.m[i][3];
    double magnitude = std::abs(map.m[i][3]);
    for (int j = 0; j < 3; ++j) {
      const double a = map.m[i][j] * double(box.lo[j]), b = map.m[i][j] * double(box.hi[j]);
      lo[i] += a < b ? a : b;
      hi[i] += a < b ? b : a;
      magnitude += std::abs(a) + std::abs(b);
    }
    const double rounding = magnitude * 0x1p-50;
    lo[i] -= rounding, hi[i] += rounding;
  }
  return {round_down(lo), round_up(hi)};
}

}  // namespace oktett
