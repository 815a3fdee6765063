#include <gtest/gtest.h>

#include "core/bytes.h"
#include "verify/cases/kernel_cases.h"
#include "verify/oracles/exact.h"

namespace oktett::cases_test {

// Findings are told by the numbers of their cases, so every compiler must draw the same: the order in which
// the arguments of a call are computed is the compiler's choice (GCC begins with the last, clang with the
// first).
TEST(Cases, OfKernelsAreTheSameForEveryCompiler) {
  Hasher hash;
  for (int id = 0; id <= static_cast<int>(KernelId::slab); ++id)
    for (int c = 0; c < kCaseClasses; ++c) {
      KernelCases cases;
      cases.fill(static_cast<KernelId>(id), static_cast<CaseClass>(c), 0, 64);
      for (std::size_t i = 0; i < 64; ++i) {
        const Ray ray = cases.rays[i];
        hash.add(ray.origin), hash.add(ray.direction);
      }
    }
  EXPECT_EQ(hash.value(), 16993409370174973952u);
}

TEST(Cases, OfSurfacesAreTheSameForEveryCompiler) {
  Hasher hash;
  for (std::size_t form = 0; form < exact_oracle_names().size(); ++form)
    for (std::uint64_t trial = 0; trial < 8; ++trial) {
      CaseRandom random(exact_key(form, trial));
      const ExactOracle oracle = draw_exact_oracle(form, random);
      for (int k = 0; k < 3; ++k) hash.add(oracle.lo[k]), hash.add(oracle.hi[k]);
      hash.add(random.unit());
    }
  EXPECT_EQ(hash.value(), 4440095939568505412u);
}

}  // namespace oktett::cases_test
