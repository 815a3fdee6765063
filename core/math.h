#pragma once
/// \file Numbers, and elementary functions whose results are the same bits on every machine.
///
/// A C library may pick among several implementations by processor, and pictures computed with them would
/// differ in the last bits. These use only + - * / and sqrt on doubles, in a fixed order. Relative error
/// below 1e-12 unless stated otherwise. NaN in gives NaN out; the limits at zeros, poles and infinities are
/// those of the C library.

#include <limits>
#include <numbers>

namespace oktett {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// A degree in radians.
inline constexpr double kDegree = std::numbers::pi / 180;

}  // namespace oktett

namespace oktett::portable {

/// 2^x. Overflows to infinity, underflows gradually to 0.
double exp2(double x);
/// e^x. The relative error grows with |x| to 2e-13 at the ends of the range.
double exp(double x);
/// Logarithms; NaN for x < 0, -infinity for 0.
double log2(double x);
double log(double x);
/// x^y; x < 0 is allowed for whole y.
double pow(double x, double y);
/// x^n by squaring: for n up to a thousand within 1e-12, and much faster than pow.
double whole_power(double x, unsigned n);

/// Sine, cosine and tangent of `x` radians. The absolute error is below 1e-15 for |x| <= 1e6 and grows
/// beyond.
double sin(double x);
double cos(double x);
double tan(double x);

double atan(double x);
/// Angle of the point (x, y) in [-pi, pi].
double atan2(double y, double x);
/// NaN outside [-1, 1].
double acos(double x);
double asin(double x);

}  // namespace oktett::portable
