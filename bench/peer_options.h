#pragma once
/// \file Options of the comparison with Embree.

#include <string>
#include <vector>

namespace oktett::bench {

/// Rows of the table, by the names that --works takes, and the scenes with things other than the mesh.
enum class Work {
  build,
  bytes,
  primary,
  shadow,
  diffuse,
  ambient_occlusion,
  equal,
  picture,
  calls,
  all_hits,
  bounces,
  instances,  ///< a scene: many instances of the mesh, or the plants
  spheres     ///< a scene: many spheres, beside the mesh if there is one
};

/// "build", "bytes", "primary", "shadow", "diffuse", "ao", "equal", "picture", "calls", "allhits", "bounces",
/// "instances", "spheres".
const std::string& to_string(Work work);

struct PeerOptions {
  std::vector<int> resolutions = {1024};  ///< edges of the square pictures, multiples of 16
  std::vector<bool> inside = {false};     ///< cameras: outside the mesh, or in the middle of it
  std::vector<int> threads = {1};
  std::vector<Work> works;  ///< rows of the scenes
  /// What is traced: the mesh itself, if empty, or these of Work::instances and Work::spheres.
  std::vector<Work> scenes;
  int instances = 4000, spheres = 1'000'000;  ///< how many the scenes hold
  double seconds = 3;  ///< time for measuring a row, beside the search for Embree's best mode
  int runs = 15;       ///< greatest number of rounds per row
  std::string build;   ///< the build quality that the rows trace; empty: the default
  std::string isa, json;
  std::vector<std::string> meshes;  ///< may be empty if `scenes` is not

  bool wants(Work work) const;
  /// Some row needs rays to be traced.
  bool wants_tracing() const;
};

/// Throws Error for unknown options and words; its text is the usage if there is no mesh.
PeerOptions parse_peer_options(int argc, char** argv);

}  // namespace oktett::bench
