#pragma once
/// \file What photons depend on, in a few numbers.

#include <deque>
#include <span>
#include <string>

#include "render/context.h"
#include "render/photon/photon_map.h"
#include "render/photon/photon_source.h"

namespace oktett {

/// Hashes of what light meets in the scene: where some thousand rays hit and in which materials, how the
/// first photons start, and where they are kept. So two scenes have the same numbers if photons cannot tell
/// them apart, however the scenes came to be; a change that none of these rays and photons meets is not seen.
/// Of a scene with motion: at all moments, with the source of each.
SceneFingerprint fingerprint(std::span<const RenderContext> moments, const std::deque<PhotonSource>& sources,
                             const PhotonPlan& plan);

/// What differs between the scene that a map was made for and this one, as one phrase; empty if nothing does.
std::string difference(const PhotonMap& map, const PhotonPlan& plan, const SceneFingerprint& scene);

}  // namespace oktett
