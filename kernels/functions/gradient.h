#pragma once
/// \file Numbers in lanes with their derivatives by x, y and z (forward automatic differentiation). NaN where
/// a function is not defined, at the poles of quotients and for the logarithm of 0, too. At kinks the
/// derivative is that of one side, at steps it is 0.

#include "core/affine_lanes.h"
#include "kernels/interval/dual.h"

namespace oktett {

/// What a derivative says of walls: places where the function jumps, has a pole or ceases to be defined.
enum class Walls {
  flat,   ///< the value and the derivative are those of the function; NaN where there are none
  steep,  ///< beyond the border of where it is defined the function goes on as its mirror image, and steps
          ///< are so steep that next to a wall the gradient points across it. The value has no meaning
};

template <class D, Walls W = Walls::flat>
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
OKTETT_INLINE Vec3<D> zero() {
  return {D(0.0), D(0.0), D(0.0)};
}
template <class D, Walls W>
OKTETT_INLINE Gradient<D, W> choose(const typename D::M& m, const Gradient<D, W>& a,
                                    const Gradient<D, W>& b) {
  return {select(m, a.v, b.v), select_lanes(m, a.d, b.d)};
}
/// f(a) with the slope f'.
template <class D, Walls W>
OKTETT_INLINE Gradient<D, W> chain(const Gradient<D, W>& a, const D& value, const D& slope) {
  return {value, scale_lanes(a.d, slope)};
}
/// Keeps what one divides by away from zero.
template <Walls W, class D>
OKTETT_INLINE D divisor(const D& x) {
  return W == Walls::flat ? x : select(abs(x) < D(0x1p-100), D(0x1p-100), x);
}
/// The slope of a step that is so far away.
template <class D>
OKTETT_INLINE D steepness(const D& distance) {
  return D(1.0) / (distance * distance + D(0x1p-100));
}
/// A step, where `jump` is the nearest place at which it jumps.
template <class D, Walls W>
OKTETT_INLINE Gradient<D, W> stepped(const Gradient<D, W>& a, const D& value, const D& jump) {
  const D v = select(a.v == a.v, value, a.v);
  return {v, W == Walls::flat ? zero<D>() : scale_lanes(a.d, steepness(a.v - jump))};
}

}  // namespace gradient

template <class D, Walls W>
OKTETT_INLINE Gradient<D, W> operator-(const Gradient<D, W>& a) {
  return gradient::chain(a, -a.v, D(-1.0));
}
template <class D, Walls W>
OKTETT_INLINE Gradient<D, W> operator+(const Gradient<D, W>& a, const Gradient<D, W>& b) {
  return {a.v + b.v, add_lanes(a.d, b.d)};
}
template <class D, Walls W>
OKTETT_INLINE Gradient<D, W> operator-(const Gradient<D, W>& a, const Gradient<D, W>& b) {
  return a + -b;
}
template <class D, Walls W>
OKTETT_INLINE Gradient<D, W> operator*(const Gradient<D, W>& a, const Gradient<D, W>& b) {
  return {a.v * b.v, add_lanes(scale_lanes(a.d, b.v), scale_lanes(b.d, a.v))};
}
template <class D, Walls W>
OKTETT_INLINE Gradient<D, W> operator/(const Gradient<D, W>& a, const Gradient<D, W>& b) {
  const D below = gradient::divisor<W>(b.v), inverse = D(1.0) / below;
  const D q = select(below == D(0.0), gradient::nan<D>(), a.v / below);
  return {q, scale_lanes(add_lanes(a.d, scale_lanes(b.d, -q)), inverse)};
}
template <class D, Walls W>
OKTETT_INLINE Gradient<D, W> times(const Gradient<D, W>& a, double b) {
  return gradient::chain(a, a.v * D(b), D(b));
}
template <class D, Walls W>
OKTETT_INLINE Gradient<D, W> plus(const Gradient<D, W>& a, double b) {
  return {a.v + D(b), a.d};
}
template <class D, Walls W>
OKTETT_INLINE Gradient<D, W> sqr(const Gradient<D, W>& a) {
  return gradient::chain(a, a.v * a.v, a.v + a.v);
}
template <class D, Walls W>
OKTETT_INLINE Gradient<D, W> sqrt(const Gradient<D, W>& a) {
  const D r = sqrt(W == Walls::flat ? a.v : abs(a.v));
  const D below = W == Walls::flat ? r : gradient::divisor<W>(abs(a.v));
  return gradient::chain(a, r, D(0.5) / below);
}
template <class D, Walls W>
OKTETT_INLINE Gradient<D, W> abs(const Gradient<D, W>& a) {
  return gradient::choose(a.v < D(0.0), -a, a);
}
template <class D, Walls W>
OKTETT_INLINE Gradient<D, W> min(const Gradient<D, W>& a, const Gradient<D, W>& b) {
  return gradient::choose((a.v <= b.v) | ~(a.v == a.v), a, b);
}
template <class D, Walls W>
OKTETT_INLINE Gradient<D, W> max(const Gradient<D, W>& a, const Gradient<D, W>& b) {
  return gradient::choose((b.v <= a.v) | ~(a.v == a.v), a, b);
}
template <class D, Walls W>
OKTETT_NOINLINE Gradient<D, W> exp(const Gradient<D, W>& a) {
  const D e = lane::exp2(a.v * D(std::numbers::log2e));
  // x^z is exp(z log(x)).
  return gradient::chain(a, e, W == Walls::flat ? e : max(e, D(1.0)));
}
template <class D, Walls W>
OKTETT_NOINLINE Gradient<D, W> log(const Gradient<D, W>& a) {
  if (W == Walls::steep) {
    const D x = gradient::divisor<W>(abs(a.v));
    return gradient::chain(a, lane::log(x), D(1.0) / x);
  }
  const D l = select(a.v == D(0.0), gradient::nan<D>(), lane::log(a.v));
  return gradient::chain(a, l, D(1.0) / a.v);
}
/// For whole n.
template <class D, Walls W>
OKTETT_NOINLINE Gradient<D, W> pow(const Gradient<D, W>& a, int exponent) {
  const int n = exponent < 0 ? -exponent : exponent;
  const D one(1.0);
  if (n == 0) return {select(a.v == a.v, one, a.v), gradient::zero<D>()};
  const D below = n == 1 ? one : lane::pow_whole(a.v, n - 1);
  const Gradient<D, W> r = gradient::chain(a, below * a.v, D(n) * below);
  return exponent < 0 ? Gradient<D, W>{one, gradient::zero<D>()} / r : r;
}
/// For a.v >= 0 and y that is not 0.
template <class D, Walls W>
OKTETT_NOINLINE Gradient<D, W> pow(const Gradient<D, W>& a, double y) {
  D exponent;
  const D x = W == Walls::flat ? a.v : gradient::divisor<W>(abs(a.v));
  const D magnitude = lane::pow(max(x, D(0.0)), D(y < 0 ? -y : y), exponent);
  const auto defined = y < 0 ? x > D(0.0) : x >= D(0.0);
  const D p = select(defined, y < 0 ? D(1.0) / magnitude : magnitude, gradient::nan<D>());
  return gradient::chain(a, p, D(y) * (W == Walls::flat ? p : max(p, D(1.0))) / x);
}
template <class D, Walls W>
OKTETT_NOINLINE void sin_cos(const Gradient<D, W>& a, Gradient<D, W>& sin, Gradient<D, W>& cos) {
  D s, c;
  lane::sin_cos(interval::clamp_angle(a.v), s, c);
  const auto defined = a.v == a.v;
  s = select(defined, s, a.v), c = select(defined, c, a.v);
  sin = gradient::chain(a, s, c), cos = gradient::chain(a, c, -s);
}
template <class D, Walls W>
OKTETT_NOINLINE Gradient<D, W> tan(const Gradient<D, W>& a) {
  Gradient<D, W> s, c;
  sin_cos(a, s, c);
  return s / c;
}
template <class D, Walls W>
OKTETT_NOINLINE Gradient<D, W> atan(const Gradient<D, W>& a) {
  return gradient::chain(a, lane::atan(a.v), D(1.0) / (D(1.0) + a.v * a.v));
}
namespace gradient {

/// sqrt(1 - x^2); near walls its square.
template <Walls W, class D>
OKTETT_INLINE D cosine_of_asin(const D& x) {
  const D square = (D(1.0) - x) * (D(1.0) + x);
  return W == Walls::flat ? sqrt(square) : divisor<W>(abs(square));
}
template <Walls W, class D>
OKTETT_INLINE D sine_range(const D& x) {
  return W == Walls::flat ? x : max(min(x, D(1.0)), D(-1.0));
}

}  // namespace gradient

template <class D, Walls W>
OKTETT_NOINLINE Gradient<D, W> asin(const Gradient<D, W>& a) {
  return gradient::chain(a, lane::asin(gradient::sine_range<W>(a.v)),
                         D(1.0) / gradient::cosine_of_asin<W>(a.v));
}
template <class D, Walls W>
OKTETT_NOINLINE Gradient<D, W> acos(const Gradient<D, W>& a) {
  return gradient::chain(a, lane::acos(gradient::sine_range<W>(a.v)),
                         D(-1.0) / gradient::cosine_of_asin<W>(a.v));
}
template <class D, Walls W>
OKTETT_NOINLINE Gradient<D, W> atan2(const Gradient<D, W>& y, const Gradient<D, W>& x) {
  const D zero(0.0), pi(std::numbers::pi);
  const D quadrant = lane::atan2_quadrant(abs(y.v), abs(x.v));
  const D upper = select(x.v < zero, pi - quadrant, quadrant);
  const D angle = select((x.v == zero) & (y.v == zero), zero, select(y.v < zero, -upper, upper));
  const D rr = gradient::divisor<W>(x.v * x.v + y.v * y.v);
  D by_y = x.v / rr;
  if (W == Walls::steep) by_y = select(x.v < zero, -gradient::steepness(y.v), by_y);
  return {angle, add_lanes(scale_lanes(y.d, by_y), scale_lanes(x.d, -y.v / rr))};
}
template <class D, Walls W>
OKTETT_NOINLINE Gradient<D, W> floor(const Gradient<D, W>& a) {
  return gradient::stepped(a, interval::floor_lanes(a.v), interval::round_lanes(a.v));
}
template <class D, Walls W>
OKTETT_NOINLINE Gradient<D, W> ceil(const Gradient<D, W>& a) {
  return gradient::stepped(a, -interval::floor_lanes(-a.v), interval::round_lanes(a.v));
}
template <class D, Walls W>
OKTETT_NOINLINE Gradient<D, W> round(const Gradient<D, W>& a) {
  return gradient::stepped(a, interval::round_lanes(a.v), interval::floor_lanes(a.v) + D(0.5));
}
template <class D, Walls W>
OKTETT_NOINLINE Gradient<D, W> sign(const Gradient<D, W>& a) {
  return gradient::stepped(a, interval::sign_lanes(a.v), D(0.0));
}

}  // namespace oktett
