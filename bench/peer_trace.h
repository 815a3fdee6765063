#pragma once
/// \file One batch of rays through Oktett, Embree and the null tracer.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "bench/bench_rays.h"
#include "bench/embree_peer.h"
#include "bench/peer_options.h"
#include "bench/peer_table.h"

namespace oktett::bench {

/// What is asked of each ray.
enum class Query { closest, any, all };

/// Rays to be traced and how.
struct Workload {
  Work work = Work::primary;
  std::string name;
  std::shared_ptr<const RayBatch> rays;
  Query query = Query::closest;
  std::size_t batch = 4096;  ///< rays of one call to Oktett; Embree gets at most so many at a time

  std::size_t size() const { return rays->size(); }
};

/// The primary rays of a view of `framed` and the rays that leave their hits, for the works in `options`.
std::vector<Workload> make_workloads(const Accel& accel, const Box& framed, const View& view,
                                     const PeerOptions& options, Isa isa);

/// The answers of a tracer: `occluded` if the workload needs no more, else `hits`. For Query::all, hits.item
/// is the number of hits of a ray, hits.t the sum of their distances.
struct Answers {
  explicit Answers(const Workload& work) {
    if (work.query == Query::any)
      occluded.resize(work.size());
    else
      hits.resize_uninitialized(work.size());
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

/// Tries every mode on every eighth piece of the rays, then the best three on all; on one thread. Modes of
/// more rays than a call of the workload has are left out.
EmbreeChoice fastest_mode(const std::vector<const EmbreeScene*>& scenes, const Workload& work);

/// "16 coherent", "16 coherent, medium".
std::string to_string(EmbreeMode mode);
std::string to_string(const EmbreeChoice& choice);

/// Counts where two tracers answered differently, as figures of that rival.
void compare(const Workload& work, const Answers& a, const Answers& b, int rival, Agreement& agreement);

}  // namespace oktett::bench
