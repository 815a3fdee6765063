#pragma once
/// \file One batch of rays through Oktett, Embree and the null tracer.

#include <cstdint>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "bench/bench_rays.h"
#include "bench/embree_peer.h"
#include "bench/peer_options.h"
#include "bench/peer_table.h"

namespace oktett::bench {

/// Rays to be traced and how.
struct Workload {
  Work work = Work::primary;
  std::string name;
  RayBatch rays;
  bool any = false;  ///< occlusion only
};

/// The primary rays of a view and the rays that leave their hits, for the works in `options`.
std::vector<Workload> make_workloads(const Accel& accel, const View& view, const PeerOptions& options,
                                     Isa isa);

/// The answers of a tracer: `hits`, or `occluded` if the workload needs no more.
struct Answers {
  explicit Answers(const Workload& work) {
    if (work.any)
      occluded.resize(work.rays.size());
    else
      hits.resize_uninitialized(work.rays.size());
  }
  HitBatch hits;
  std::vector<std::uint8_t> occluded;
};

void trace(const Accel& accel, const Workload& work, Isa isa, int threads, Answers& answers);
void trace(const EmbreeScene& scene, EmbreeMode mode, const Workload& work, int threads, Answers& answers);
/// The null tracer: reads the rays and stores misses. No tracer can be faster.
void trace_nothing(const Workload& work, int threads, Answers& answers);

/// An Embree scene and its fastest mode for a workload.
struct EmbreeChoice {
  const EmbreeScene* scene = nullptr;
  EmbreeMode mode;
  double seconds = 0;
};

/// Tries every mode on every eighth piece of the rays, then the best three on all; on one thread.
EmbreeChoice fastest_mode(const std::vector<const EmbreeScene*>& scenes, const Workload& work);

/// "16 coherent".
std::string to_string(EmbreeMode mode);

/// Counts where two tracers answered differently. Names of mesh and view are left to the caller.
Agreement compare(const Workload& work, const Answers& a, const Answers& b);

}  // namespace oktett::bench
