#pragma once
/// \file What solids and media do to photons: where these start in them, and how much light passes.

#include <span>
#include <vector>

#include "render/context.h"
#include "render/photon/photon_choices.h"
#include "render/photon/photon_source.h"

namespace oktett {

/// The solids that each photon starts in. Those of the first photon of an emitter are found by enclosures_at;
/// for the others the surfaces between the two places are counted. Empty if the scene tracks no solids.
std::vector<EnclosureStack> start_enclosures(const RenderContext& context,
                                             std::span<const PhotonStart> starts);

/// The part of the light that passes a segment inside of the solids given, see MediumTracker::transmittance.
Color passing_media(const RenderContext& context, const EnclosureStack& around, const MediumSegment& segment,
                    TrackingNumbers numbers);

/// For each photon the part of its light that reaches its start: 1, but for photons from infinitely far away.
/// Surfaces without bounds may stand in their way, with holes or as boundaries of media, and so may a medium
/// that fills all space. `numbers[i]` are the random numbers of photon i; `around` is from start_enclosures.
std::vector<Color> reaching_start(const RenderContext& context, std::span<const PhotonStart> starts,
                                  std::span<const EnclosureStack> around,
                                  std::span<const TrackingNumbers> numbers);

}  // namespace oktett
