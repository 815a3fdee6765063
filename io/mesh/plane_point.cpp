#include "io/mesh/plane_point.h"

#include <cmath>

#include "core/double_double.h"

namespace oktett {

/// The sign of a sum of six numbers, by an expansion whose parts do not overlap.
static int sign_of_sum(const double (&terms)[6]) {
  double parts[6];
  int count = 0;
  for (double carry : terms) {
    for (int i = 0; i < count; ++i) {
      const DoubleDouble sum = two_sum(carry, parts[i]);
      carry = sum.hi, parts[i] = sum.lo;
    }
    parts[count++] = carry;
  }
  while (count > 0 && parts[count - 1] == 0) --count;
  return count == 0 ? 0 : parts[count - 1] > 0 ? 1 : -1;
}

int orientation(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  const double left = (b.x - a.x) * (c.y - a.y), right = (b.y - a.y) * (c.x - a.x), area = left - right;
  // (3 + 16 u) u times the sum of the magnitudes, with u = 2^-53.
  const double error = 0x1.8000000000008p-52 * (std::abs(left) + std::abs(right));
  if (area > error) return 1;
  if (area < -error) return -1;
  // Products of floats are exact.
  return sign_of_sum({a.x * b.y, -(a.y * b.x), b.x * c.y, -(b.y * c.x), c.x * a.y, -(c.y * a.x)});
}

}  // namespace oktett
