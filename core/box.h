#pragma once
/// \file Axis-aligned boxes.

#include <bit>
#include <cstdint>
#include <limits>

#include "core/vec3.h"

namespace oktett {

/// Axis-aligned box [lo, hi]. The default box is empty: lo = +inf, hi = -inf.
struct Box {
  Vec3f lo{kInf, kInf, kInf};
  Vec3f hi{-kInf, -kInf, -kInf};

  constexpr bool operator==(const Box&) const = default;

  /// True if no point is in the box; also if a coordinate is NaN.
  OKTETT_INLINE constexpr bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
  /// Extends the box to contain `p`, or all of `b`. A NaN changes nothing.
  OKTETT_INLINE constexpr void grow(const Vec3f& p) { lo = min(p, lo), hi = max(p, hi); }
  OKTETT_INLINE constexpr void grow(const Box& b) { lo = min(b.lo, lo), hi = max(b.hi, hi); }
  OKTETT_INLINE constexpr Vec3f center() const { return lo * 0.5f + hi * 0.5f; }
  /// The lengths of the edges; zero for an empty box.
  OKTETT_INLINE constexpr Vec3f extent() const { return empty() ? Vec3f{} : hi - lo; }
  OKTETT_INLINE constexpr bool contains(const Vec3f& p) const {
    return lo.x <= p.x && p.x <= hi.x && lo.y <= p.y && p.y <= hi.y && lo.z <= p.z && p.z <= hi.z;
  }
  OKTETT_INLINE constexpr bool contains(const Box& b) const { return contains(b.lo) && contains(b.hi); }

  /// Half of the surface area; 0 for an empty box.
  OKTETT_INLINE constexpr float half_area() const {
    const Vec3f e = extent();
    return e.x * e.y + e.y * e.z + e.z * e.x;
  }

 private:
  static constexpr float kInf = std::numeric_limits<float>::infinity();
};

/// The next float above `f`, which is not NaN; infinity for the greatest and for infinity. The result of
/// std::nextafter, inline.
OKTETT_INLINE float next_up(float f) {
  if (!(f < std::numeric_limits<float>::infinity())) return f;
  const auto bits = std::bit_cast<std::int32_t>(f);
  if (f == 0) return std::numeric_limits<float>::denorm_min();
  return std::bit_cast<float>(bits < 0 ? bits - 1 : bits + 1);
}
/// The next float below `f`, likewise.
OKTETT_INLINE float next_down(float f) { return -next_up(-f); }

/// The smallest float >= v. With round_down, bounds in double become a Box that contains them.
OKTETT_INLINE float round_up(double v) {
  const float f = static_cast<float>(v);
  return static_cast<double>(f) >= v ? f : next_up(f);
}
/// The largest float <= v.
OKTETT_INLINE float round_down(double v) { return -round_up(-v); }

/// The same component by component.
OKTETT_INLINE Vec3f round_up(const Vec3d& v) { return {round_up(v.x), round_up(v.y), round_up(v.z)}; }
OKTETT_INLINE Vec3f round_down(const Vec3d& v) { return {round_down(v.x), round_down(v.y), round_down(v.z)}; }

}  // namespace oktett
