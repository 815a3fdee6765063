#pragma once
/// \file Penumbras of lamps in Whitted's model: a hit that sees some points of its pattern and not others
/// asks more points. Penumbras are a small part of most pictures but hold nearly all noise of soft shadows.

#include "render/transport/wavefront.h"

namespace oktett {

/// Makes the wavefront ready for the hits of a bounce, none of which is in a penumbra yet.
void start_penumbras(const RenderContext& context, Wavefront& wavefront);

/// Traces the queued shadow rays to points of area lights and adds the light that arrives. A hit in a
/// penumbra receives only the share of the points that it has asked so far, and is put on
/// `wavefront.penumbra`. All rays of a hit must be queued at once.
void flush_lamp_shadows(const RenderContext& context, Wavefront& wavefront);

/// Asks the other points for all hits on `wavefront.penumbra`, and adds their share of the light.
void shade_penumbras(const RenderContext& context, Wavefront& wavefront);

}  // namespace oktett
