#pragma once
/// \file Vectors of two and three components, for points, directions, normals and colours.

#include <cmath>

#include "core/platform.h"

namespace oktett {

/// Three components, zero unless given.
template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  constexpr T operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  bool operator==(const Vec3&) const = default;

  /// Converts component by component, e.g. `Vec3d(v)` from a Vec3f.
  template <class U>
  OKTETT_INLINE explicit constexpr operator Vec3<U>() const {
    return {static_cast<U>(x), static_cast<U>(y), static_cast<U>(z)};
  }

  OKTETT_INLINE constexpr Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
  OKTETT_INLINE constexpr Vec3& operator-=(const Vec3& b) { return *this = *this - b; }
  OKTETT_INLINE constexpr Vec3& operator*=(T s) { return *this = *this * s; }

  friend OKTETT_INLINE constexpr Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend OKTETT_INLINE constexpr Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend OKTETT_INLINE constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend OKTETT_INLINE constexpr Vec3 operator*(const Vec3& a, T s) { return {a.x * s, a.y * s, a.z * s}; }
  friend OKTETT_INLINE constexpr Vec3 operator*(T s, const Vec3& a) { return a * s; }
  /// Component-wise product, for colours.
  friend OKTETT_INLINE constexpr Vec3 operator*(const Vec3& a, const Vec3& b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
  }
  friend OKTETT_INLINE constexpr Vec3 operator/(const Vec3& a, T s) { return {a.x / s, a.y / s, a.z / s}; }
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;
/// Linear Rec.709 colour.
using Color = Vec3<float>;

/// Two components, zero unless given; for uv.
struct Vec2f {
  float x{}, y{};
  constexpr bool operator==(const Vec2f&) const = default;
};

/// The scalar product.
template <class T>
OKTETT_INLINE constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The vector product, right-handed.
template <class T>
OKTETT_INLINE constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The Euclidean length.
template <class T>
OKTETT_INLINE T length(const Vec3<T>& a) {
  return std::sqrt(dot(a, a));
}

/// Unit vector along `a`; NaN for the zero vector.
template <class T>
OKTETT_INLINE Vec3<T> normalize(const Vec3<T>& a) {
  return a / length(a);
}

/// The lesser of each component; where either is NaN, that of `b`.
template <class T>
OKTETT_INLINE constexpr Vec3<T> min(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}

/// The greater of each component; where either is NaN, that of `b`.
template <class T>
OKTETT_INLINE constexpr Vec3<T> max(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}

/// The magnitude of each component.
template <class T>
OKTETT_INLINE Vec3<T> abs(const Vec3<T>& a) {
  return {std::abs(a.x), std::abs(a.y), std::abs(a.z)};
}

/// Whether every component is 0: for colours, no light.
template <class T>
OKTETT_INLINE constexpr bool is_black(const Vec3<T>& a) {
  return a == Vec3<T>{0, 0, 0};
}

/// The greatest of the components.
template <class T>
OKTETT_INLINE constexpr T max_component(const Vec3<T>& a) {
  const T xy = a.x > a.y ? a.x : a.y;
  return xy > a.z ? xy : a.z;
}

/// Whether no component is infinite or NaN.
template <class T>
OKTETT_INLINE bool is_finite(const Vec3<T>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// Index of the component of greatest magnitude; the lowest index wins ties.
template <class T>
OKTETT_INLINE int dominant_axis(const Vec3<T>& a) {
  const Vec3<T> m = abs(a);
  if (m.x >= m.y && m.x >= m.z) return 0;
  return m.y >= m.z ? 1 : 2;
}

/// Two unit vectors that with the unit vector `n` form a right-handed basis (Duff et al. 2017, JCGT 6(1)).
template <class T>
OKTETT_INLINE void make_basis(const Vec3<T>& n, Vec3<T>& tangent, Vec3<T>& bitangent) {
  const T sign = std::copysign(T(1), n.z);
  const T a = T(-1) / (sign + n.z);
  const T b = n.x * n.y * a;
  tangent = {T(1) + sign * n.x * n.x * a, sign * b, -sign * n.x};
  bitangent = {b, sign + n.y * n.y * a, -n.y};
}

}  // namespace oktett
