#pragma once
/// \file The queries of accel/accel.h with a prescribed traversal, for verification and benchmarks; and all
/// crossings of rays with what all_hits does not tell.

#include <cstddef>
#include <span>
#include <vector>

#include "accel/accel.h"
#include "accel/hit_sink.h"

namespace oktett {

/// The traversal that a query uses. Hits have the same bits in every mode; only the speed differs. The scalar
/// set traces every ray alone; the others have packets of 8 rays, AVX-512 also of 16. Where a set lacks
/// packets of 16, those of 8 are used.
enum class TraceMode : std::uint8_t {
  automatic,    ///< beams for rays that share a point, packets for other coherent rays, the rest interleaved;
                ///< in batches of a few rays, each ray alone
  single,       ///< one ray after the other
  interleaved,  ///< single rays, many in flight (without vector registers: like `single`)
  packet8,
  packet16,
  beam,  ///< like automatic, but no beam is given up, however small the triangles
};

void closest_hit(const Accel& accel, const RaySpan& rays, const HitSpan& hits, Isa isa, TraceMode mode);
void any_hit(const Accel& accel, const RaySpan& rays, std::uint8_t* occluded, Isa isa, TraceMode mode);

/// The crossings of each ray of a batch: those of ray i are crossings[begin[i]] to crossings[begin[i + 1] -
/// 1].
struct CrossingLists {
  std::vector<Crossing> crossings;
  std::vector<std::size_t> begin;

  std::span<const Crossing> of_ray(std::size_t i) const {
    return {crossings.data() + begin[i], begin[i + 1] - begin[i]};
  }
};

/// What all_hits lists of at most 4096 rays, with the turn of each crossing.
void all_crossings(const Accel& accel, const RaySpan& rays, CrossingLists& lists, Isa isa);

}  // namespace oktett
