#pragma once
/// \file One way of tracing against another.

#include <cstring>
#include <initializer_list>
#include <vector>

#include "accel/accel.h"
#include "accel/query.h"

namespace oktett {

inline constexpr std::initializer_list<TraceMode> kTraceModes = {
    TraceMode::automatic, TraceMode::single, TraceMode::packet8,
    TraceMode::packet16,  TraceMode::beam,   TraceMode::interleaved};

inline bool same_bits(float a, float b) { return std::memcmp(&a, &b, sizeof a) == 0; }
inline bool same_bits(const Vec3f& a, const Vec3f& b) {
  return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
}
static_assert(sizeof(Hit) == 20, "a hit has no padding");
inline bool same_bits(const Hit& a, const Hit& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// Traces `rays` on `isa` in `mode`. Calls differs(i, closest, any) for each ray whose closest hit has other
/// bits than `reference` (`closest`) or whose occlusion contradicts it (`any`).
template <class F>
void compare_mode(const Accel& accel, const RayBatch& rays, const HitBatch& reference, Isa isa,
                  TraceMode mode, const F& differs) {
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  std::vector<std::uint8_t> occluded(rays.size());
  closest_hit(accel, rays.span(), hits.span(), isa, mode);
  any_hit(accel, rays.span(), occluded.data(), isa, mode);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool closest = !same_bits(hits[i], reference[i]), any = (occluded[i] != 0) != reference[i].valid();
    if (closest || any) differs(i, closest, any);
  }
}

}  // namespace oktett
