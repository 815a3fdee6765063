#pragma once
/// \file Shadow rays of Whitted's model to one light.

#include <cstddef>
#include <span>

#include "render/fog.h"
#include "render/shading_columns.h"
#include "render/transport/ray_queue.h"

namespace oktett {

/// Finishes the rays from `first` on, which lead to a light: sets where they begin and end, and takes from
/// their light what distance, but for 1/r^2, the angle to its axis and, if it is dimmed by them, `fogs` cost.
void finish_light_rays(const LightSource& light, std::span<const Fog> fogs, std::size_t first,
                       ShadowQueue& queue);

}  // namespace oktett
