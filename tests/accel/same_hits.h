#pragma once
/// \file Every instruction set and trace mode against single rays of the scalar code.

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

#include "verify/checks/compare_mode.h"

namespace oktett {

/// What single rays hit in the scalar code.
inline HitBatch scalar_hits(const Accel& accel, const RayBatch& rays) {
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  closest_hit(accel, rays.span(), hits.span(), Isa::scalar, TraceMode::single);
  return hits;
}

/// Expects of every instruction set, in each of `modes`, that the closest hits in `accel` have the bits of
/// `expected` and that any-hit queries agree with them. Returns the number of rays that hit; 0 after a
/// failure.
inline int expect_hits(const Accel& accel, const RayBatch& rays, const HitBatch& expected,
                       std::initializer_list<TraceMode> modes, const std::string& what = {}) {
  for (const Isa isa : available_isas())
    for (const TraceMode mode : modes) {
      compare_mode(accel, rays, expected, isa, mode, [&](std::size_t i, bool closest, bool) {
        if (testing::Test::HasFailure()) return;
        ADD_FAILURE() << what << ' ' << to_string(isa) << " mode " << int(mode) << " ray " << i << ", "
                      << (closest ? "closest" : "any") << " hit; expected t " << expected[i].t << " of "
                      << rays[i].tmax << ", item " << expected[i].item;
      });
      if (testing::Test::HasFailure()) return 0;
    }
  int count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) count += expected[i].valid();
  return count;
}

}  // namespace oktett
