#pragma once
/// \file The point that best lies in several planes. Within io/ only.

#include "core/vec3.h"

namespace oktett {

/// The quadratic error function of Ju, Losasso, Schaefer and Warren 2002 ("Dual Contouring of Hermite Data"):
/// the sum of the squared distances from planes.
class PlaneError {
 public:
  /// The plane through `point` with the unit normal `normal`.
  void add(const Vec3d& point, const Vec3d& normal);

  /// The point of least error next to `start`: along directions in which the error grows by less than kLeast
  /// of the most, it stays where it is. Of the directions at most `rank` are solved for.
  Vec3d minimum(const Vec3d& start, int rank = 3) const;

 private:
  static constexpr double kLeast = 0.01;
  double m_[3][3] = {};  ///< sum of n n^T
  Vec3d v_;              ///< sum of (n . p) n
};

}  // namespace oktett
