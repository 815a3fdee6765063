#pragma once
/// \file Embree 3 or 4 behind the few calls that the comparison needs.

#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/peer_scene.h"
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

/// How a scene is built.
struct EmbreeKind {
  int quality = 1;        ///< 1 = medium, 2 = high
  bool robust = false;    ///< no ray slips through between triangles (RTC_SCENE_FLAG_ROBUST)
  bool collects = false;  ///< `all_hits` may be asked: the filter functions of a query are called
  auto operator<=>(const EmbreeKind&) const = default;
};

/// One scene.
class EmbreeScene {
 public:
  /// `config` is Embree's device configuration, e.g. "isa=avx2". It builds on as many threads as TBB may use
  /// here: a limit in `config` would hold for the whole process.
  EmbreeScene(const PeerScene& scene, EmbreeKind kind, const std::string& config);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  EmbreeKind kind() const { return kind_; }
  /// False for the mode in which Embree 3.13.5 does not come back: 16 coherent rays, asked whether they hit
  /// anything, in a scene of instances.
  bool comes_back(EmbreeMode mode, bool any) const {
    return !(has_instances_ && any && mode.width == 16 && mode.coherent);
  }
  double build_seconds() const { return build_seconds_; }
  /// Bytes that Embree allocated, its copies of vertices and indices included.
  std::size_t bytes() const { return bytes_; }

  /// Rays [begin, begin + count); results as Oktett's own: t = inf and item = kNoId for misses.
  void closest_hit(const RaySpan& rays, const HitSpan& hits, EmbreeMode mode) const;
  void any_hit(const RaySpan& rays, std::uint8_t* occluded, EmbreeMode mode) const;
  /// Every hit of each ray, collected by a filter function that rejects it, then sorted, those found twice
  /// removed: hits.item becomes their number, hits.t the sum of their distances.
  void all_hits(const RaySpan& rays, const HitSpan& hits, EmbreeMode mode) const;

 private:
  EmbreeKind kind_;
  bool has_instances_;
  RTCDeviceTy* device_;
  RTCSceneTy* scene_;
  double build_seconds_;
  std::size_t bytes_;
};

/// "3.13.5" or the like.
const char* embree_version();

}  // namespace oktett::bench
