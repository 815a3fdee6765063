#pragma once
/// \file What must hold for any structure and any rays, however odd: all ways to ask agree.

#include "accel/accel.h"
#include "tests/fuzz/input.h"
#include "verify/checks/compare_mode.h"

namespace oktett::test {

/// Rays of raw numbers.
inline std::vector<Ray> take_rays(InputBytes& bytes, std::size_t most) {
  std::vector<Ray> rays;
  while (rays.size() < most && !bytes.empty()) {
    Ray r;
    for (int k = 0; k < 3; ++k) r.origin[k] = bytes.number();
    for (int k = 0; k < 3; ++k) r.direction[k] = bytes.number();
    if (const auto range = bytes.take<std::uint8_t>(); range & 1)
      r.tmin = bytes.number(), r.tmax = bytes.number();
    rays.push_back(r);
  }
  return rays;
}

/// Asks for all rays in all ways; returns the closest hits.
inline std::vector<Hit> trace_every_way(const Accel& accel, const std::vector<Ray>& rays) {
  std::vector<Hit> hits(rays.size()), scalar(rays.size());
  closest_hit(accel, rays, hits);
  closest_hit(accel, rays, scalar, Isa::scalar);
  std::vector<std::uint8_t> occluded(rays.size());
  any_hit(accel, rays, occluded);
  std::vector<Hit> all;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    require(same_bits(hits[i], scalar[i]), "the same bits with and without vectors");
    require((occluded[i] != 0) == hits[i].valid(), "any_hit and closest_hit agree");
    require(any_hit(accel, rays[i]) == hits[i].valid(), "one ray and a batch agree");
    all.clear();
    all_hits(accel, rays[i], all);
    require(all.empty() != hits[i].valid(), "all_hits and closest_hit agree");
    if (!hits[i].valid()) continue;
    require(hits[i].t > rays[i].tmin && hits[i].t <= rays[i].tmax, "hits lie in the ray's range");
    for (const Hit& h : all) require(h.t >= hits[i].t, "the closest hit is the first");
  }
  return hits;
}

}  // namespace oktett::test
