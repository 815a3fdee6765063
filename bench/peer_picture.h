#pragma once
/// \file From a file to the first picture: reading, building and one primary frame, with Oktett and with
/// tinyobjloader and Embree.

#include <array>
#include <string>

#include "bench/bench_rays.h"
#include "bench/embree_peer.h"
#include "bench/peer_options.h"
#include "bench/peer_table.h"

namespace oktett::bench {

/// What the row needs besides its options.
struct PictureTask {
  std::string path;
  View view;
  int threads = 1;
  Isa isa = Isa::scalar;
  BuildOptions build;
  std::array<EmbreeMode, kRivals> modes;  ///< in which Embree traces primary rays
  std::string config;                     ///< of Embree's device
};

/// Fills the row's figures in seconds. False if there is no tinyobjloader.
bool race_to_first_picture(const PictureTask& task, const PeerOptions& options, Row& row);

}  // namespace oktett::bench
