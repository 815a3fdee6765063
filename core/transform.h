#pragma once
/// \file Affine transforms of points, directions and normals, in double.

#include <array>
#include <cstddef>

#include "core/box.h"
#include "core/vec3.h"

namespace oktett {

/// The affine map p -> M p + t, stored as the row-major 3x4 matrix [M | t].
struct Affine {
  std::array<std::array<double, 4>, 3> m{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

  bool operator==(const Affine&) const = default;

  /// p -> p + t.
  static Affine translation(const Vec3d& t);
  /// Multiplies component k by s[k].
  static Affine scaling(const Vec3d& s);
  /// Rotation about the x, then the y, then the z axis; angles in degrees, right-handed.
  static Affine rotation(const Vec3d& degrees);
  /// Rotation by `degrees` about `axis`, which need not be of unit length but must not be zero.
  static Affine rotation(const Vec3d& axis, double degrees);

  /// From and to a row-major 3x4 matrix.
  template <class T>
  static Affine from_rows(const T* rows) {
    Affine a;
    for (std::size_t k = 0; k < 12; ++k) a.m[k / 4][k % 4] = static_cast<double>(rows[k]);
    return a;
  }
  template <class T>
  void to_rows(T* rows) const {
    for (std::size_t k = 0; k < 12; ++k) rows[k] = static_cast<T>(m[k / 4][k % 4]);
  }

  /// M p + t.
  Vec3d point(const Vec3d& p) const;
  /// M v, for directions and differences of points.
  Vec3d vector(const Vec3d& v) const;
  /// M^T n, not normalised: if *this is the inverse of the map that moves a surface, this maps its normals.
  Vec3d normal_by_inverse(const Vec3d& n) const;

  /// Determinant of the linear part; negative for a mirror.
  double determinant() const;
  /// The inverse map; each entry is off by a few roundings, measured in the greatest of its row. For a
  /// singular map the result holds non-finite numbers: call `is_invertible` first.
  Affine inverse() const;
  /// True if all entries are finite and the map has a finite inverse.
  bool is_invertible() const;
  /// The same where the inverse is known already.
  bool is_invertible(const Affine& known_inverse) const;
  /// True if all entries are exactly those of the identity.
  bool is_identity() const { return *this == Affine{}; }
  /// If the map is a uniform scale, possibly with rotation, mirror and translation, its scale factor; else 0.
  double uniform_scale() const;

  /// (a * b)(p) = a(b(p)).
  friend Affine operator*(const Affine& a, const Affine& b);
};

/// How far a point with |p[k]| <= reach[k] is displaced, at most, along each axis of its space by what rounds
/// when `map` takes it to another space. `inverse` is the inverse of `map`. The displacement is greater than
/// a few roundings of the coordinates where `map` stretches a direction that is none of the axes.
Vec3d displacement(const Affine& map, const Affine& inverse, const Vec3d& reach);

/// The bounds of the image of `box`, rounded outwards.
Box transform_bounds(const Affine& map, const Box& box);

}  // namespace oktett
