#pragma once
/// \file The rows of one scene in the comparison with Embree.

#include "bench/peer_options.h"
#include "bench/peer_scene.h"
#include "bench/peer_table.h"
#include "core/isa.h"

namespace oktett::bench {

/// Measures the rows that `options` want, prints them, and adds them to `report`.
void compare_scene(const PeerScene& scene, const PeerOptions& options, Isa isa, PeerReport& report);

}  // namespace oktett::bench
