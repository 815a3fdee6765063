#include "accel/csg.h"

#include <gtest/gtest.h>

#include "app/verify_csg.h"

namespace oktett {

/// Random trees of random solids against sampling: no span on the wrong side, normals outwards, the same bits
/// everywhere.
TEST(Csg, AgreesWithSampling) {
  const CsgTally t = verify_csg(20000, available_isas());
  EXPECT_EQ(t.wrong(), 0u) << t.wrong_spans << " spans, " << t.wrong_first << " firsts, " << t.wrong_normal
                           << " normals, " << t.differing << " differing; " << t.failure;
  EXPECT_GT(t.crossings, t.rays / 4);
}

}  // namespace oktett
