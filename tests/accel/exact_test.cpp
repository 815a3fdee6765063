#include "verify/checks/exact.h"

#include <gtest/gtest.h>

namespace oktett::exact_test {

/// Every form against its oracle: no first hit missed or invented, positions within their bounds, all
/// crossings entering and leaving in turn, the same bits in every mode, width and instruction set.
TEST(Exact, AgreesWithItsOracle) {
  const std::vector<std::string> names = exact_oracle_names();
  for (std::size_t form = 0; form < names.size(); ++form) {
    const ExactTally t = verify_exact(form, 2048, available_isas());
    EXPECT_EQ(t.wrong(), 0u) << names[form] << ": " << t.missed << " missed, " << t.invented << " invented, "
                             << t.off_surface << " off the surface, " << t.lists << " lists, " << t.differing
                             << " differing; " << t.failure;
    EXPECT_GT(t.hits, t.rays / 10) << names[form];
    EXPECT_LE(t.worst_residual, 1) << names[form];
  }
}

}  // namespace oktett::exact_test
