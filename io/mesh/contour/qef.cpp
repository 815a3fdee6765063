#include "io/mesh/contour/qef.h"

#include <algorithm>
#include <cmath>

namespace oktett {

void PlaneError::add(const Vec3d& point, const Vec3d& normal) {
  const double d = dot(point, normal);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m_[i][j] += normal[i] * normal[j];
    v_[i] += d * normal[i];
  }
}

/// Eigenvalues on the diagonal of `a`, which is symmetric, and eigenvectors in the columns of `q`, by
/// Jacobi's rotations.
static void diagonalize(double (&a)[3][3], double (&q)[3][3]) {
  for (int sweep = 0; sweep < 12; ++sweep) {
    const double off = a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2];
    if (!(off > 1e-30 * (a[0][0] * a[0][0] + a[1][1] * a[1][1] + a[2][2] * a[2][2]))) return;
    for (int i = 0; i < 2; ++i)
      for (int j = i + 1; j < 3; ++j) {
        if (a[i][j] == 0) continue;
        const double theta = (a[j][j] - a[i][i]) / (2 * a[i][j]);
        const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (auto& row : a) {
          const double x = row[i], y = row[j];
          row[i] = c * x - s * y, row[j] = s * x + c * y;
        }
        for (int k = 0; k < 3; ++k) {
          const double x = a[i][k], y = a[j][k];
          a[i][k] = c * x - s * y, a[j][k] = s * x + c * y;
        }
        for (auto& row : q) {
          const double x = row[i], y = row[j];
          row[i] = c * x - s * y, row[j] = s * x + c * y;
        }
      }
  }
}

Vec3d PlaneError::minimum(const Vec3d& start, int rank) const {
  double a[3][3], q[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Vec3d rest = v_;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) a[i][j] = m_[i][j], rest[i] -= m_[i][j] * start[j];
  diagonalize(a, q);
  int order[] = {0, 1, 2};
  std::sort(order, order + 3, [&](int i, int j) { return a[i][i] > a[j][j]; });
  Vec3d p = start;
  for (int k = 0; k < rank; ++k) {
    const int i = order[k];
    if (!(a[i][i] > kLeast * a[order[0]][order[0]])) break;
    const Vec3d along{q[0][i], q[1][i], q[2][i]};
    p += along * (dot(along, rest) / a[i][i]);
  }
  return p;
}

}  // namespace oktett
