#include "render/transport/view_directions.h"

#include "render/transport/render_code.h"

namespace oktett {

void view_directions(const ViewPlane& plane, const ViewPoints& points, Isa isa) {
  render_code(isa).view_directions(plane, points);
}

}  // namespace oktett
