#include "accel/view_rays.h"

#include "accel/isa/table.h"

namespace oktett {

void view_directions(const ViewPlane& plane, const ViewPoints& points, Isa isa) {
  isa_table(isa)->view_directions(plane, points);
}

}  // namespace oktett
