#pragma once
/// \file Embree 3 or 4 behind the few calls that the comparison needs.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/mesh.h"
#include "core/ray.h"

struct RTCDeviceTy;
struct RTCSceneTy;

namespace oktett::bench {

/// How rays are handed to Embree: one, eight or sixteen at a time, with its hint for coherent rays or not.
struct EmbreeMode {
  int width = 1;
  bool coherent = false;
};

/// All modes that are tried; the fastest one counts.
const std::vector<EmbreeMode>& embree_modes();

/// One mesh in one Embree scene.
class EmbreeScene {
 public:
  /// `quality`: 1 = medium, 2 = high. `config` is Embree's device configuration, e.g. "isa=avx2".
  /// It builds on as many threads as TBB may use here: a limit in `config` would hold for the whole process.
  EmbreeScene(const TriangleMesh& mesh, int quality, const char* config);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  double build_seconds() const { return build_seconds_; }
  /// Bytes that Embree allocated, its copies of vertices and indices included.
  std::size_t bytes() const { return bytes_; }

  /// Rays [begin, begin + count); results as Oktett's own: t = inf and item = kNoId for misses.
  void closest_hit(const RaySpan& rays, const HitSpan& hits, EmbreeMode mode) const;
  void any_hit(const RaySpan& rays, std::uint8_t* occluded, EmbreeMode mode) const;

 private:
  RTCDeviceTy* device_;
  RTCSceneTy* scene_;
  double build_seconds_;
  std::size_t bytes_;
};

/// "3.13.5" or the like.
const char* embree_version();

}  // namespace oktett::bench
