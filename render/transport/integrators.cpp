#include "render/transport/integrators.h"

namespace oktett {

const Integrator& integrator(IntegratorKind kind) {
  // In the order of IntegratorKind.
  static constexpr Integrator table[] = {
      {nullptr, shade_whitted_block},
      {nullptr, shade_path_block},
      {shade_ambient_occlusion, nullptr},
      {shade_normal, nullptr},
      {shade_depth, nullptr},
      {shade_albedo, nullptr},
      {shade_uv, nullptr},
      {shade_position, nullptr},
      {shade_object, nullptr},
      {shade_primitive, nullptr},
      {shade_facing, nullptr},
      {shade_wire, nullptr},
  };
  return table[static_cast<std::size_t>(kind)];
}

}  // namespace oktett
