#pragma once
/// \file Elementary functions that are rounded to the nearest double: the same bits on every machine, and the
/// best that a double can hold.
///
/// For numbers that users write, such as constants in scenes. The C library's depend on its version, on the
/// architecture and on whether the processor fuses multiplications and additions. These compute in numbers of
/// 106 bits, in a fixed order, so all but about one result in 10^12 is the nearest double, and no result is
/// further than the next. They take about a microsecond; code that runs per sample takes those of
/// core/math.h. NaN in gives NaN out; poles, zeros, infinities and signs are those of the C standard, annex
/// F.

namespace oktett::precise {

double exp(double x);
double log(double x);
double log2(double x);
double log10(double x);
double pow(double x, double y);
double sin(double x);
double cos(double x);
double tan(double x);
double asin(double x);
double acos(double x);
double atan(double x);
/// Angle of the point (x, y) in [-pi, pi].
double atan2(double y, double x);
/// The length of (x, y); infinite if either is, even beside NaN.
double hypot(double x, double y);

}  // namespace oktett::precise
