#pragma once
/// \file Where the nodes of a glTF file are at a time, and how its meshes are bent. Within io/ only.

#include <cstdint>
#include <optional>
#include <vector>

#include "core/transform.h"
#include "io/gltf/accessor.h"
#include "io/gltf/model.h"

namespace oktett {

/// The nodes at a time.
struct GltfPose {
  std::vector<Affine> to_parent, to_world;   ///< of each node
  std::vector<std::vector<double>> weights;  ///< of the morph targets of each node's mesh
};

/// The animations of a file.
class GltfAnimator {
 public:
  /// Reads the keys of all animations if `moves`. Throws Error if they are damaged.
  GltfAnimator(GltfAccessors& accessors, bool moves);

  /// The nodes so many seconds after the start, before the first key and after the last one as at these; as
  /// the file places them without a time.
  GltfPose at(std::optional<double> time) const;

  bool moves() const { return !tracks_.empty(); }

 private:
  struct Track {
    GltfChannel channel;
    std::vector<float> times, values;
    std::size_t width = 0;  ///< numbers of a value
  };

  void read(const GltfChannel& channel, std::size_t number);
  static std::vector<double> value_at(const Track& track, double time);

  GltfAccessors& accessors_;
  std::vector<Track> tracks_;
};

/// The transforms of a skin's joints in a pose, from the mesh as it is stored to the world. Throws Error.
std::vector<Affine> gltf_joints(GltfAccessors& accessors, const GltfSkin& skin, const GltfPose& pose);

}  // namespace oktett
