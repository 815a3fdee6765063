#include "kernels/exact/quadratic.h"

#include <cmath>

#include "core/double_double.h"

namespace oktett {

static DoubleDouble cross(double a, double b, double c, double d) {
  return two_product(a, d) - two_product(b, c);
}

void circle_discriminant(const double (&in)[4], double (&out)[1]) {
  const DoubleDouble c = cross(in[0], in[1], in[2], in[3]);
  out[0] = (two_product(in[2], in[2]) + two_product(in[3], in[3]) - c * c).hi;
}

void cone_discriminant(const double (&in)[6], double (&out)[1]) {
  const DoubleDouble xw = cross(in[0], in[2], in[3], in[5]), yw = cross(in[1], in[2], in[4], in[5]),
                     xy = cross(in[0], in[1], in[3], in[4]);
  out[0] = (xw * xw + yw * yw - xy * xy).hi;
}

double unit_for(double half) {
  int exponent;
  const double fraction = std::frexp(half, &exponent);
  return std::ldexp(1.0, fraction == 0.5 ? exponent - 1 : exponent);
}

double origin_for(double center, double unit) { return std::round(center / unit * 256) / 256 * unit; }

}  // namespace oktett
