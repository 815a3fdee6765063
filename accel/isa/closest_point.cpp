#include "accel/point_code.h"
#include "accel/traverse/closest.h"
#include "core/simd_native.h"

namespace oktett {

template <class A>
static void closest(const Accel& accel, const PointSpan& points, Nearest* nearest) {
  for (std::size_t i = 0; i < points.size; ++i) {
    nearest[i] = {};
    const Vec3f p = points[i];
    const float sum = (p.x - p.x) + (p.y - p.y) + (p.z - p.z);
    // Nothing is nearest to a point that is not finite.
    if (sum == 0) ClosestSearch<A>(accel, nearest[i]).run(place_point(accel, p));
  }
}

template <class A>
const PointCode& point_code() {
  static constexpr PointCode code = {closest<A>};
  return code;
}

template const PointCode& point_code<OKTETT_ISA>();

}  // namespace oktett
