/// \file The check of root finders has hard cases, and finds nothing wrong.

#include "verify/checks/kernels.h"

#include <gtest/gtest.h>

namespace oktett::roots_test {
namespace {

TEST(KnownRoots, AreFound) {
  for (int degree = 1; degree <= kKnownRootsDegree; ++degree) {
    const RootsTally t = verify_roots(degree, 2000);
    EXPECT_EQ(t.wrong, 0u) << t.failure << ", number " << t.first_failure;
    EXPECT_EQ(t.polynomials, 2000u);
    EXPECT_GT(t.roots, 2000u / 4);
    // Sturm chains end at multiple roots, and closed forms where roots are close together.
    EXPECT_EQ(t.uncertain > 100, degree > 1) << t.uncertain;
  }
}

}  // namespace
}  // namespace oktett::roots_test
