#pragma once
/// \file All crossings of a ray, checked on every instruction set.

#include <gtest/gtest.h>

#include <vector>

#include "accel/accel.h"

namespace oktett {

/// The list of all_hits, after a check that closest_hit and any_hit agree with its first entry on every
/// instruction set.
inline std::vector<Hit> all_crossings(const Accel& accel, const Ray& ray) {
  std::vector<Hit> all;
  for (const Isa isa : available_isas()) {
    all_hits(accel, ray, all, isa);
    // As many rays as a packet has, so that lanes are used.
    RayBatch rays;
    for (int i = 0; i < 16; ++i) rays.push_back(ray);
    HitBatch hits;
    hits.resize_uninitialized(rays.size());
    std::vector<std::uint8_t> occluded(rays.size());
    closest_hit(accel, rays.span(), hits.span(), isa);
    any_hit(accel, rays.span(), occluded, isa);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_EQ(hits[i], all.empty() ? Hit{} : all[0]) << to_string(isa);
      EXPECT_EQ(occluded[i], all.empty() ? 0 : 1) << to_string(isa);
    }
  }
  return all;
}

inline std::vector<Hit> all_crossings(const ExactForm& form, const Ray& ray, const Affine& to_world = {}) {
  return all_crossings(*build_accel({{ExactShape{form}, to_world}}), ray);
}

}  // namespace oktett
