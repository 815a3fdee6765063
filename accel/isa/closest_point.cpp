#include "accel/point_code.h"
#include "accel/traverse/closest.h"
#include "core/simd_native.h"

namespace oktett {

template <class A>
static void closest(const Accel& accel, const PointSpan& points, Nearest* nearest) {
  Vec3d last_point;
  NodeRef hint = NodeRef::none();
  Nearest last;
  for (std::size_t i = 0; i < points.size; ++i) {
    const Vec3f p = points[i];
    const float zero = (p.x - p.x) + (p.y - p.y) + (p.z - p.z);
    // Nothing is nearest to a point that is not finite.
    nearest[i] = {};
    if (zero != 0) continue;
    const PointPlace place = place_point(accel, p);
    Nearest best = nearest_by(place, last_point, last);
    ClosestSearch<A> search(accel, best);
    search.start(place, hint);
    search.run(place);
    hint = search.found();
    if (best.item == kNoId) continue;
    nearest[i] = last = best;
    last_point = place.world;
  }
}

template <class A>
const PointCode& point_code() {
  static constexpr PointCode code = {closest<A>};
  return code;
}

template const PointCode& point_code<OKTETT_ISA>();

}  // namespace oktett
