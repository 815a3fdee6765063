#pragma once
/// \file Shadow rays: how much light arrives from each light.

#include "render/context.h"
#include "render/ray_queue.h"

namespace oktett {

/// Traces all rays of `queue` and adds to entry `owner` of `radiance` the light that arrives, in the order of
/// the queue. Opaque materials block it; transparent ones attenuate it by colour * transparency and do not
/// bend it.
void trace_shadows(const RenderContext& context, ShadowQueue& queue, ColorColumn& radiance);

}  // namespace oktett
