#include "render/view_directions.h"

#include "render/view_code.h"

namespace oktett {

void view_directions(const ViewPlane& plane, const ViewPoints& points, Isa isa) {
  view_code(isa).directions(plane, points);
}

}  // namespace oktett
