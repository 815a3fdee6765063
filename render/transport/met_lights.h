#pragma once
/// \file Light samples and bounces that lead to the same light are weighted against each other (Veach 1997),
/// so both must agree whether its light arrives. Where shadow rays do not meet what bounces meet (see
/// Object::visible_to), shadow rays decide: along each bounce that a light sample could replace, the emitters
/// are looked for by themselves, and a shadow ray asks whether the light of each arrives.

#include "render/transport/wavefront.h"

namespace oktett {

/// Lists in wavefront.met_lights the light of sampled emitters that the rays of a bounce lead to. For
/// RenderContext::shadows_decide; throughputs are those at the rays' origins.
void find_met_lights(const RenderContext& context, Wavefront& wavefront);

/// Traces shadow rays for them, and adds the light that arrives.
void add_met_lights(const RenderContext& context, Wavefront& wavefront);

}  // namespace oktett
