#pragma once
/// \file All crossings of a ray, checked on every instruction set.

#include <gtest/gtest.h>

#include <vector>

#include "accel/accel.h"
#include "accel/query.h"

namespace oktett {

/// Checks that the answers of closest_hit and any_hit, with rays in lanes, are the first entries of lists.
inline void expect_first(const Accel& accel, const RayBatch& rays, const std::vector<std::vector<Hit>>& all,
                         Isa isa, TraceMode mode) {
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  std::vector<std::uint8_t> occluded(rays.size());
  closest_hit(accel, rays.span(), hits.span(), isa, mode);
  any_hit(accel, rays.span(), occluded.data(), isa, mode);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(hits[i], all[i].empty() ? Hit{} : all[i][0]) << to_string(isa) << ", ray " << i;
    EXPECT_EQ(occluded[i], all[i].empty() ? 0 : 1) << to_string(isa) << ", ray " << i;
  }
}

/// The list of all_hits, after a check that closest_hit and any_hit agree with its first entry on every
/// instruction set.
inline std::vector<Hit> all_crossings(const Accel& accel, const Ray& ray) {
  // As many rays as a packet has, so that lanes are used.
  constexpr std::size_t kLanes = 16;
  RayBatch rays;
  for (std::size_t i = 0; i < kLanes; ++i) rays.push_back(ray);
  std::vector<Hit> all;
  for (const Isa isa : available_isas()) {
    all_hits(accel, ray, all, isa);
    expect_first(accel, rays, std::vector(kLanes, all), isa, TraceMode::automatic);
  }
  return all;
}

/// The same for rays that share packets, in their order.
inline std::vector<std::vector<Hit>> all_crossings(const Accel& accel, const RayBatch& rays) {
  std::vector<std::vector<Hit>> all(rays.size());
  for (const Isa isa : available_isas()) {
    for (std::size_t i = 0; i < rays.size(); ++i) all_hits(accel, rays[i], all[i], isa);
    expect_first(accel, rays, all, isa, TraceMode::packet16);
  }
  return all;
}

inline std::vector<Hit> all_crossings(const ExactForm& form, const Ray& ray, const Affine& to_world = {}) {
  return all_crossings(*build_accel({{ExactShape{form}, to_world}}), ray);
}

}  // namespace oktett
