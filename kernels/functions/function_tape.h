#pragma once
/// \file Functions of x, y and z as tapes: lists of steps over a few registers, compiled once from a text and
/// run on intervals, on intervals with derivatives, on variations, or on numbers with gradients.
///
/// Equal subexpressions are computed once, those without x, y and z when the text is read. A sine and a
/// cosine of the same angle are one step.

#include "kernels/functions/gradient.h"
#include "kernels/functions/tape_data.h"

namespace oktett {

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
    case TapeOp::constant:
      return set(out, s.c);
    case TapeOp::negate:
      return void(out = -a);
    case TapeOp::add:
      return void(out = a + b);
    case TapeOp::add_constant:
      return void(out = plus(a, s.c));
    case TapeOp::subtract:
      return void(out = a - b);
    case TapeOp::multiply:
      return void(out = a * b);
    case TapeOp::multiply_constant:
      return void(out = times(a, s.c));
    case TapeOp::divide:
      return void(out = a / b);
    case TapeOp::square:
      return void(out = sqr(a));
    case TapeOp::whole_power:
      return void(out = pow(a, s.n));
    case TapeOp::real_power:
      return void(out = pow(a, s.c));
    case TapeOp::sqrt:
      return void(out = sqrt(a));
    case TapeOp::abs:
      return void(out = abs(a));
    case TapeOp::sin:
      return void(out = sin(a));
    case TapeOp::cos:
      return void(out = cos(a));
    case TapeOp::sin_cos: {
      T sine, cosine;
      sin_cos(a, sine, cosine);
      out = sine, r[s.b] = cosine;
      return;
    }
    case TapeOp::tan:
      return void(out = tan(a));
    case TapeOp::asin:
      return void(out = asin(a));
    case TapeOp::acos:
      return void(out = acos(a));
    case TapeOp::atan:
      return void(out = atan(a));
    case TapeOp::atan2:
      return void(out = atan2(a, b));
    case TapeOp::exp:
      return void(out = exp(a));
    case TapeOp::log:
      return void(out = log(a));
    case TapeOp::min:
      return void(out = min(a, b));
    case TapeOp::max:
      return void(out = max(a, b));
    case TapeOp::floor:
      return void(out = floor(a));
    case TapeOp::ceil:
      return void(out = ceil(a));
    case TapeOp::round:
      return void(out = round(a));
    case TapeOp::sign:
      return void(out = sign(a));
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
