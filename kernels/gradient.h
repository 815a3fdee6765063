#pragma once
/// \file Numbers in lanes with their derivatives by x, y and z (forward automatic differentiation). NaN where
/// a function is not defined, at the poles of quotients, too; the logarithm of 0 is -infinity.
/// At kinks the derivative is that of one side, at steps it is 0.

#include "core/vec3.h"
#include "kernels/interval/dual.h"

namespace oktett {

template <class D>
struct Gradient {
  D v;
  Vec3<D> d;
};

namespace gradient {

template <class D>
OKTETT_INLINE D nan() {
  return D(std::numeric_limits<double>::quiet_NaN());
}
template <class D>
OKTETT_INLINE Vec3<D> scaled(const Vec3<D>& d, const D& by) {
  return {d.x * by, d.y * by, d.z * by};
}
template <class D>
OKTETT_INLINE Vec3<D> sum(const Vec3<D>& a, const Vec3<D>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class D>
OKTETT_INLINE Vec3<D> zero() {
  return {D(0.0), D(0.0), D(0.0)};
}
template <class D>
OKTETT_INLINE Gradient<D> choose(const typename D::M& m, const Gradient<D>& a, const Gradient<D>& b) {
  return {select(m, a.v, b.v), {select(m, a.d.x, b.d.x), select(m, a.d.y, b.d.y), select(m, a.d.z, b.d.z)}};
}
/// f(a) with the slope f'.
template <class D>
OKTETT_INLINE Gradient<D> chain(const Gradient<D>& a, const D& value, const D& slope) {
  return {value, scaled(a.d, slope)};
}
template <class D>
OKTETT_INLINE Gradient<D> stepped(const Gradient<D>& a, const D& value) {
  return {select(a.v == a.v, value, a.v), zero<D>()};
}

}  // namespace gradient

template <class D>
OKTETT_INLINE Gradient<D> operator-(const Gradient<D>& a) {
  return gradient::chain(a, -a.v, D(-1.0));
}
template <class D>
OKTETT_INLINE Gradient<D> operator+(const Gradient<D>& a, const Gradient<D>& b) {
  return {a.v + b.v, gradient::sum(a.d, b.d)};
}
template <class D>
OKTETT_INLINE Gradient<D> operator-(const Gradient<D>& a, const Gradient<D>& b) {
  return a + -b;
}
template <class D>
OKTETT_INLINE Gradient<D> operator*(const Gradient<D>& a, const Gradient<D>& b) {
  return {a.v * b.v, gradient::sum(gradient::scaled(a.d, b.v), gradient::scaled(b.d, a.v))};
}
template <class D>
OKTETT_INLINE Gradient<D> operator/(const Gradient<D>& a, const Gradient<D>& b) {
  const D q = select(b.v == D(0.0), gradient::nan<D>(), a.v / b.v), inverse = D(1.0) / b.v;
  return {q, gradient::scaled(gradient::sum(a.d, gradient::scaled(b.d, -q)), inverse)};
}
template <class D>
OKTETT_INLINE Gradient<D> times(const Gradient<D>& a, double b) {
  return gradient::chain(a, a.v * D(b), D(b));
}
template <class D>
OKTETT_INLINE Gradient<D> plus(const Gradient<D>& a, double b) {
  return {a.v + D(b), a.d};
}
template <class D>
OKTETT_INLINE Gradient<D> sqr(const Gradient<D>& a) {
  return gradient::chain(a, a.v * a.v, a.v + a.v);
}
template <class D>
OKTETT_INLINE Gradient<D> sqrt(const Gradient<D>& a) {
  const D r = sqrt(a.v);
  return gradient::chain(a, r, D(0.5) / r);
}
template <class D>
OKTETT_INLINE Gradient<D> abs(const Gradient<D>& a) {
  return gradient::choose(a.v < D(0.0), -a, a);
}
template <class D>
OKTETT_INLINE Gradient<D> min(const Gradient<D>& a, const Gradient<D>& b) {
  return gradient::choose((a.v <= b.v) | ~(a.v == a.v), a, b);
}
template <class D>
OKTETT_INLINE Gradient<D> max(const Gradient<D>& a, const Gradient<D>& b) {
  return gradient::choose((b.v <= a.v) | ~(a.v == a.v), a, b);
}
template <class D>
OKTETT_INLINE Gradient<D> exp(const Gradient<D>& a) {
  const D e = lane::exp2(a.v * D(std::numbers::log2e));
  return gradient::chain(a, e, e);
}
template <class D>
OKTETT_INLINE Gradient<D> log(const Gradient<D>& a) {
  return gradient::chain(a, lane::log(a.v), D(1.0) / a.v);
}
/// For whole n.
template <class D>
OKTETT_INLINE Gradient<D> pow(const Gradient<D>& a, int exponent) {
  const int n = exponent < 0 ? -exponent : exponent;
  const D one(1.0);
  if (n == 0) return {select(a.v == a.v, one, a.v), gradient::zero<D>()};
  const D below = n == 1 ? one : lane::pow_whole(a.v, n - 1);
  const Gradient<D> r = gradient::chain(a, below * a.v, D(n) * below);
  return exponent < 0 ? Gradient<D>{one, gradient::zero<D>()} / r : r;
}
/// For a.v >= 0 and y that is not 0.
template <class D>
OKTETT_INLINE Gradient<D> pow(const Gradient<D>& a, double y) {
  D exponent;
  const D magnitude = lane::pow(max(a.v, D(0.0)), D(y < 0 ? -y : y), exponent);
  const auto defined = y < 0 ? a.v > D(0.0) : a.v >= D(0.0);
  const D p = select(defined, y < 0 ? D(1.0) / magnitude : magnitude, gradient::nan<D>());
  return gradient::chain(a, p, D(y) * p / a.v);
}
template <class D>
OKTETT_INLINE void sin_cos(const Gradient<D>& a, Gradient<D>& sin, Gradient<D>& cos) {
  D s, c;
  lane::sin_cos(interval::clamp_angle(a.v), s, c);
  const auto defined = a.v == a.v;
  s = select(defined, s, a.v), c = select(defined, c, a.v);
  sin = gradient::chain(a, s, c), cos = gradient::chain(a, c, -s);
}
template <class D>
OKTETT_INLINE Gradient<D> sin(const Gradient<D>& a) {
  Gradient<D> s, c;
  sin_cos(a, s, c);
  return s;
}
template <class D>
OKTETT_INLINE Gradient<D> cos(const Gradient<D>& a) {
  Gradient<D> s, c;
  sin_cos(a, s, c);
  return c;
}
template <class D>
OKTETT_INLINE Gradient<D> tan(const Gradient<D>& a) {
  Gradient<D> s, c;
  sin_cos(a, s, c);
  return s / c;
}
template <class D>
OKTETT_INLINE Gradient<D> atan(const Gradient<D>& a) {
  return gradient::chain(a, lane::atan(a.v), D(1.0) / (D(1.0) + a.v * a.v));
}
template <class D>
OKTETT_INLINE Gradient<D> asin(const Gradient<D>& a) {
  return gradient::chain(a, lane::asin(a.v), D(1.0) / sqrt((D(1.0) - a.v) * (D(1.0) + a.v)));
}
template <class D>
OKTETT_INLINE Gradient<D> acos(const Gradient<D>& a) {
  return gradient::chain(a, lane::acos(a.v), D(-1.0) / sqrt((D(1.0) - a.v) * (D(1.0) + a.v)));
}
template <class D>
OKTETT_INLINE Gradient<D> atan2(const Gradient<D>& y, const Gradient<D>& x) {
  const D zero(0.0), pi(std::numbers::pi);
  const D quadrant = lane::atan2_quadrant(abs(y.v), abs(x.v));
  const D upper = select(x.v < zero, pi - quadrant, quadrant);
  const D angle = select((x.v == zero) & (y.v == zero), zero, select(y.v < zero, -upper, upper));
  const D rr = x.v * x.v + y.v * y.v;
  return {angle, gradient::sum(gradient::scaled(y.d, x.v / rr), gradient::scaled(x.d, -y.v / rr))};
}
template <class D>
OKTETT_INLINE Gradient<D> floor(const Gradient<D>& a) {
  return gradient::stepped(a, interval::floor_lanes(a.v));
}
template <class D>
OKTETT_INLINE Gradient<D> ceil(const Gradient<D>& a) {
  return gradient::stepped(a, -interval::floor_lanes(-a.v));
}
template <class D>
OKTETT_INLINE Gradient<D> round(const Gradient<D>& a) {
  return gradient::stepped(a, interval::round_lanes(a.v));
}
template <class D>
OKTETT_INLINE Gradient<D> sign(const Gradient<D>& a) {
  return gradient::stepped(a, interval::sign_lanes(a.v));
}

}  // namespace oktett
