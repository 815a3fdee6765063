#pragma once
/// \file Functions of x, y and z as tapes: lists of steps over a few registers, compiled once from a text and
/// run on intervals, on intervals with derivatives, on variations, or on numbers with gradients.
///
/// Equal subexpressions are computed once, those without x, y and z when the text is read. A sine and a
/// cosine of the same angle are one step.

#include <span>

#include "core/lanes.h"
#include "core/mesh.h"
#include "kernels/functions/noise_lanes.h"
#include "kernels/functions/tape_data.h"
#include "kernels/interval/dual.h"

namespace oktett {

// ---- A function as a list of values, each computed once from values before it: the form in which a tape is
// made and cut down. It has no registers, so that a value may be left out without moving others.

/// A value, and the numbers in the list of the values that it is computed from. The first three values of a
/// list are x, y and z, which are not computed. A sine and a cosine are values of their own; sin_cos does not
/// occur.
struct TapeValue {
  TapeOp op = TapeOp::constant;
  std::uint32_t a = kNoId, b = kNoId;
  int n = 0;
  double c = 0;
  std::uint32_t third = kNoId;  ///< the third operand of `noise`
};

/// A tape that computes value number `root`, without the values that it does not need. Throws Error if it is
/// too long or needs too many registers.
FunctionTape write_tape(std::span<const TapeValue> values, std::uint32_t root);

/// The values of a tape, one or two for each step.
struct TapeValues {
  std::vector<TapeValue> list;
  std::uint32_t root = 0;
};
TapeValues values_of(const FunctionTape& tape);

// ---- Numbers in lanes with their derivatives by x, y and z or along a line (forward automatic
// differentiation). They are NaN where a function is not defined, also at the poles of quotients and for the
// logarithm of 0. At kinks the derivative is that of one side, at steps it is 0.

/// What a derivative says of walls: places where the function jumps, has a pole or ceases to be defined.
enum class Walls {
  flat,   ///< the value and the derivative are those of the function; NaN where there are none
  steep,  ///< beyond the border of where it is defined the function goes on as its mirror image, and steps
          ///< are so steep that next to a wall the gradient points across it. The value has no meaning
};

/// A number and its derivatives: V is Vec3<D> for those by x, y and z, or D for the one along a line.
template <class D, Walls W = Walls::flat, class V = Vec3<D>>
struct Gradient {
  D v;
  V d;
};

// The functions of vectors for derivatives along a line, which are single numbers.
template <class T, int N, class A>
OKTETT_INLINE Simd<T, N, A> add_lanes(const Simd<T, N, A>& a, const Simd<T, N, A>& b) {
  return a + b;
}
template <class T, int N, class A>
OKTETT_INLINE Simd<T, N, A> scale_lanes(const Simd<T, N, A>& a, const Simd<T, N, A>& b) {
  return a * b;
}
template <class T, int N, class A>
OKTETT_INLINE Simd<T, N, A> select_lanes(const Mask<T, N, A>& m, const Simd<T, N, A>& a,
                                         const Simd<T, N, A>& b) {
  return select(m, a, b);
}

namespace gradient {

template <class D>
OKTETT_INLINE D nan() {
  return D(std::numeric_limits<double>::quiet_NaN());
}
template <class V>
OKTETT_INLINE V zero() {
  if constexpr (requires(V v) { v.x; }) {
    const decltype(V::x) none(0.0);
    return {none, none, none};
  } else {
    return V(0.0);
  }
}
template <class D, Walls W, class V>
OKTETT_INLINE Gradient<D, W, V> choose(const typename D::M& m, const Gradient<D, W, V>& a,
                                       const Gradient<D, W, V>& b) {
  return {select(m, a.v, b.v), select_lanes(m, a.d, b.d)};
}
/// f(a) with the slope f'.
template <class D, Walls W, class V>
OKTETT_INLINE Gradient<D, W, V> chain(const Gradient<D, W, V>& a, const D& value, const D& slope) {
  return {value, scale_lanes(a.d, slope)};
}
/// A divisor; with steep walls it is kept away from zero.
template <Walls W, class D>
OKTETT_INLINE D divisor(const D& x) {
  return W == Walls::flat ? x : select(abs(x) < D(0x1p-100), D(0x1p-100), x);
}
/// The slope that stands for a step at this distance.
template <class D>
OKTETT_INLINE D steepness(const D& distance) {
  return D(1.0) / (distance * distance + D(0x1p-100));
}
/// A step, where `jump` is the nearest place at which it jumps.
template <class D, Walls W, class V>
OKTETT_INLINE Gradient<D, W, V> stepped(const Gradient<D, W, V>& a, const D& value, const D& jump) {
  const D v = select(a.v == a.v, value, a.v);
  return {v, W == Walls::flat ? zero<V>() : scale_lanes(a.d, steepness(a.v - jump))};
}

}  // namespace gradient

template <class D, Walls W, class V>
OKTETT_INLINE Gradient<D, W, V> operator-(const Gradient<D, W, V>& a) {
  return gradient::chain(a, -a.v, D(-1.0));
}
template <class D, Walls W, class V>
OKTETT_INLINE Gradient<D, W, V> operator+(const Gradient<D, W, V>& a, const Gradient<D, W, V>& b) {
  return {a.v + b.v, add_lanes(a.d, b.d)};
}
template <class D, Walls W, class V>
OKTETT_INLINE Gradient<D, W, V> operator-(const Gradient<D, W, V>& a, const Gradient<D, W, V>& b) {
  return a + -b;
}
template <class D, Walls W, class V>
OKTETT_INLINE Gradient<D, W, V> operator*(const Gradient<D, W, V>& a, const Gradient<D, W, V>& b) {
  return {a.v * b.v, add_lanes(scale_lanes(a.d, b.v), scale_lanes(b.d, a.v))};
}
template <class D, Walls W, class V>
OKTETT_INLINE Gradient<D, W, V> operator/(const Gradient<D, W, V>& a, const Gradient<D, W, V>& b) {
  const D below = gradient::divisor<W>(b.v), inverse = D(1.0) / below;
  const D q = select(below == D(0.0), gradient::nan<D>(), a.v / below);
  return {q, scale_lanes(add_lanes(a.d, scale_lanes(b.d, -q)), inverse)};
}
template <class D, Walls W, class V>
OKTETT_INLINE Gradient<D, W, V> times(const Gradient<D, W, V>& a, double b) {
  return gradient::chain(a, a.v * D(b), D(b));
}
template <class D, Walls W, class V>
OKTETT_INLINE Gradient<D, W, V> plus(const Gradient<D, W, V>& a, double b) {
  return {a.v + D(b), a.d};
}
template <class D, Walls W, class V>
OKTETT_INLINE Gradient<D, W, V> sqr(const Gradient<D, W, V>& a) {
  return gradient::chain(a, a.v * a.v, a.v + a.v);
}
template <class D, Walls W, class V>
OKTETT_INLINE Gradient<D, W, V> sqrt(const Gradient<D, W, V>& a) {
  const D r = sqrt(W == Walls::flat ? a.v : abs(a.v));
  const D below = W == Walls::flat ? r : gradient::divisor<W>(abs(a.v));
  return gradient::chain(a, r, D(0.5) / below);
}
template <class D, Walls W, class V>
OKTETT_INLINE Gradient<D, W, V> abs(const Gradient<D, W, V>& a) {
  return gradient::choose(a.v < D(0.0), -a, a);
}
template <class D, Walls W, class V>
OKTETT_INLINE Gradient<D, W, V> min(const Gradient<D, W, V>& a, const Gradient<D, W, V>& b) {
  return gradient::choose((a.v <= b.v) | ~(a.v == a.v), a, b);
}
template <class D, Walls W, class V>
OKTETT_INLINE Gradient<D, W, V> max(const Gradient<D, W, V>& a, const Gradient<D, W, V>& b) {
  return gradient::choose((b.v <= a.v) | ~(a.v == a.v), a, b);
}
template <class D, Walls W, class V>
OKTETT_NOINLINE Gradient<D, W, V> exp(const Gradient<D, W, V>& a) {
  const D e = lane::exp2(a.v * D(std::numbers::log2e));
  // x^z is exp(z log(x)).
  return gradient::chain(a, e, W == Walls::flat ? e : max(e, D(1.0)));
}
template <class D, Walls W, class V>
OKTETT_NOINLINE Gradient<D, W, V> log(const Gradient<D, W, V>& a) {
  if (W == Walls::steep) {
    const D x = gradient::divisor<W>(abs(a.v));
    return gradient::chain(a, lane::log(x), D(1.0) / x);
  }
  const D l = select(a.v == D(0.0), gradient::nan<D>(), lane::log(a.v));
  return gradient::chain(a, l, D(1.0) / a.v);
}
/// For whole n.
template <class D, Walls W, class V>
OKTETT_NOINLINE Gradient<D, W, V> pow(const Gradient<D, W, V>& a, int exponent) {
  const int n = exponent < 0 ? -exponent : exponent;
  const D one(1.0);
  if (n == 0) return {select(a.v == a.v, one, a.v), gradient::zero<V>()};
  const D below = n == 1 ? one : lane::pow_whole(a.v, n - 1);
  const Gradient<D, W, V> r = gradient::chain(a, below * a.v, D(n) * below);
  return exponent < 0 ? Gradient<D, W, V>{one, gradient::zero<V>()} / r : r;
}
/// For a.v >= 0 and y that is not 0.
template <class D, Walls W, class V>
OKTETT_NOINLINE Gradient<D, W, V> pow(const Gradient<D, W, V>& a, double y) {
  D exponent;
  const D x = W == Walls::flat ? a.v : gradient::divisor<W>(abs(a.v));
  const D magnitude = lane::pow(max(x, D(0.0)), D(y < 0 ? -y : y), exponent);
  const auto defined = y < 0 ? x > D(0.0) : x >= D(0.0);
  const D p = select(defined, y < 0 ? D(1.0) / magnitude : magnitude, gradient::nan<D>());
  return gradient::chain(a, p, D(y) * (W == Walls::flat ? p : max(p, D(1.0))) / x);
}
template <class D, Walls W, class V>
OKTETT_NOINLINE void sin_cos(const Gradient<D, W, V>& a, Gradient<D, W, V>& sin, Gradient<D, W, V>& cos) {
  D s, c;
  lane::sin_cos(interval::clamp_angle(a.v), s, c);
  const auto defined = a.v == a.v;
  s = select(defined, s, a.v), c = select(defined, c, a.v);
  sin = gradient::chain(a, s, c), cos = gradient::chain(a, c, -s);
}
template <class D, Walls W, class V>
OKTETT_NOINLINE Gradient<D, W, V> tan(const Gradient<D, W, V>& a) {
  Gradient<D, W, V> s, c;
  sin_cos(a, s, c);
  return s / c;
}
template <class D, Walls W, class V>
OKTETT_NOINLINE Gradient<D, W, V> atan(const Gradient<D, W, V>& a) {
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

template <class D, Walls W, class V>
OKTETT_NOINLINE Gradient<D, W, V> asin(const Gradient<D, W, V>& a) {
  return gradient::chain(a, lane::asin(gradient::sine_range<W>(a.v)),
                         D(1.0) / gradient::cosine_of_asin<W>(a.v));
}
template <class D, Walls W, class V>
OKTETT_NOINLINE Gradient<D, W, V> acos(const Gradient<D, W, V>& a) {
  return gradient::chain(a, lane::acos(gradient::sine_range<W>(a.v)),
                         D(-1.0) / gradient::cosine_of_asin<W>(a.v));
}
template <class D, Walls W, class V>
OKTETT_NOINLINE Gradient<D, W, V> atan2(const Gradient<D, W, V>& y, const Gradient<D, W, V>& x) {
  const D zero(0.0), pi(std::numbers::pi);
  const D quadrant = lane::atan2_quadrant(abs(y.v), abs(x.v));
  const D upper = select(x.v < zero, pi - quadrant, quadrant);
  const D angle = select((x.v == zero) & (y.v == zero), zero, select(y.v < zero, -upper, upper));
  const D rr = gradient::divisor<W>(x.v * x.v + y.v * y.v);
  D by_y = x.v / rr;
  if (W == Walls::steep) by_y = select(x.v < zero, -gradient::steepness(y.v), by_y);
  return {angle, add_lanes(scale_lanes(y.d, by_y), scale_lanes(x.d, -y.v / rr))};
}
template <class D, Walls W, class V>
OKTETT_NOINLINE Gradient<D, W, V> floor(const Gradient<D, W, V>& a) {
  return gradient::stepped(a, interval::floor_lanes(a.v), interval::round_lanes(a.v));
}
template <class D, Walls W, class V>
OKTETT_NOINLINE Gradient<D, W, V> ceil(const Gradient<D, W, V>& a) {
  return gradient::stepped(a, -interval::floor_lanes(-a.v), interval::round_lanes(a.v));
}
template <class D, Walls W, class V>
OKTETT_NOINLINE Gradient<D, W, V> round(const Gradient<D, W, V>& a) {
  return gradient::stepped(a, interval::round_lanes(a.v), interval::floor_lanes(a.v) + D(0.5));
}
template <class D, Walls W, class V>
OKTETT_NOINLINE Gradient<D, W, V> sign(const Gradient<D, W, V>& a) {
  return gradient::stepped(a, interval::sign_lanes(a.v), D(0.0));
}
template <class D, Walls W, class V>
OKTETT_NOINLINE Gradient<D, W, V> noise(const Gradient<D, W, V>& x, const Gradient<D, W, V>& y,
                                        const Gradient<D, W, V>& z, NoiseKind kind) {
  Gradient<D, W, V> r;
  Vec3<D> by;
  noise_lanes::slope(x.v, y.v, z.v, kind, r.v, by);
  r.d = add_lanes(add_lanes(scale_lanes(x.d, by.x), scale_lanes(y.d, by.y)), scale_lanes(z.d, by.z));
  return r;
}

// ---- Functions of x, y and z as tapes.

namespace tape {

template <class D, Walls W, class V>
OKTETT_INLINE void set(Gradient<D, W, V>& r, double c) {
  r = {D(c), gradient::zero<V>()};
}

/// One step. T is Interval, Dual of Interval, Variation, or Gradient.
template <class T>
OKTETT_INLINE void run_step(const TapeStep& s, T* r) {
  T& out = r[s.out];
  const T &a = r[s.a], &b = r[s.b];
  switch (s.op) {
#define OP(name, text, step) \
  case TapeOp::name: {       \
    step;                    \
    return;                  \
  }
    OKTETT_TAPE_OPS(OP)
#undef OP
  }
}

}  // namespace tape

/// The function at (x, y, z).
template <class T>
OKTETT_NOINLINE T run_tape(const FunctionTape& tape, const T& x, const T& y, const T& z) {
  T r[3 + kMaxTapeRegisters];
  r[0] = x, r[1] = y, r[2] = z;
  const std::size_t count = tape.steps.size();
  const TapeStep* steps = tape.steps.data();
  for (std::size_t i = 0; i < count; ++i) tape::run_step(steps[i], r);
  return r[tape.result];
}

}  // namespace oktett
