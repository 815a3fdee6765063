#include "render/transport/render_code.h"

#include "render/isa/camera_rays.h"
#include "render/isa/light_code.h"
#include "render/isa/shading.h"
#include "render/isa/wavefront_lanes.h"
#include "render/transport/path_shading.h"

namespace oktett {

template <class A>
const RenderCode& render_code() {
  static const RenderCode code = {ShadingLanes<A>::kWidth, kDoubleLanes<A>,      view_directions_code<A>,
                                  lens_rays_code<A>,       sobol_points_code<A>, begin_shading_code<A>,
                                  shadow_rays_code<A>,     bounce_rays_code<A>,  queue_rays_code<A>,
                                  begin_path_code<A>,      shade_phong_code<A>,  shade_principled_code<A>,
                                  light_code<A>(),         split_rays_code<A>,   block_light_code<A>,
                                  add_colors_code<A>,      all_finite_code<A>};
  return code;
}

template const RenderCode& render_code<OKTETT_ISA>();

}  // namespace oktett
