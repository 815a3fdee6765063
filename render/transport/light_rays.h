#pragma once
/// \file Shadow rays of Whitted's model to one light.

#include <cstddef>

#include "render/shading_columns.h"
#include "render/transport/ray_queue.h"

namespace oktett {

/// Finishes the rays from `first` on, which lead to a light: sets where they begin and end, and takes from
/// their light what distance and the angle to its axis cost, but for 1/r^2.
void finish_light_rays(const LightSource& light, std::size_t first, ShadowQueue& queue);

}  // namespace oktett
