#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "kernels/roots/roots.h"
#include "tests/support/exact_roots.h"
#include "tests/support/random_polynomials.h"
#include "verify/probes/kernel_probe.h"

namespace oktett::roots_lanes_test {
namespace {

using test::RootClass;
using test::RootProblem;

struct LaneKernel {
  RootsKernel id;
  int degree, roots;
  bool certified;
};
constexpr LaneKernel kLaneKernels[] = {
    {RootsKernel::closed2, 2, 2, false}, {RootsKernel::closed3, 3, 3, false},
    {RootsKernel::closed4, 4, 4, false}, {RootsKernel::all2, 2, 2, true},
    {RootsKernel::all3, 3, 3, true},     {RootsKernel::all4, 4, 4, true},
    {RootsKernel::all6, 6, 6, true},     {RootsKernel::first4, 4, 1, true},
};

/// Problems in columns, and answers.
struct Columns {
  std::vector<double> c[7], a, b, x[6], error[6];
  std::vector<std::uint8_t> unsure;

  void push(const roots::Polynomial& p, double from, double to) {
    for (int k = 0; k < 7; ++k) c[k].push_back(k <= p.degree ? p.c[k] : 0);
    a.push_back(from), b.push_back(to);
  }
  void solve(RootsKernel id, Isa isa, std::size_t begin, std::size_t count) {
    RootsProbe run;
    run.count = count;
    for (int k = 0; k < 7; ++k) run.c[k] = c[k].data() + begin;
    run.a = a.data() + begin, run.b = b.data() + begin;
    for (int k = 0; k < 6; ++k) {
      x[k].assign(count + 1, -7), error[k].assign(count + 1, -7);
      run.x[k] = x[k].data(), run.error[k] = error[k].data();
    }
    unsure.assign(count + 1, 77);
    run.unsure = unsure.data();
    probe_roots(isa, id, run);
  }
  roots::Roots answer(std::size_t i, int ranks) const {
    roots::Roots r;
    for (int k = 0; k < ranks; ++k) {
      if (x[k][i] < roots::kNoRoot) r.add({x[k][i], error[k][i], 1});
    }
    return r;
  }
};

class RootsInLanes : public testing::TestWithParam<int> {
 protected:
  const LaneKernel& kernel() const { return kLaneKernels[GetParam()]; }
  Columns columns(std::uint64_t count) const {
    Columns out;
    for (std::uint64_t i = 0; i < count; ++i) {
      const RootProblem q =
          test::random_problem(static_cast<RootClass>(i % test::kRootClasses), kernel().degree, i);
      out.push(q.p, q.a, q.b);
    }
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();
    for (const double odd : {nan, inf, -inf, 0.0, 1e300, 1e-300}) {
      for (int k = 0; k <= kernel().degree + 2; ++k) {
        roots::Polynomial p;
        p.degree = kernel().degree;
        for (int i = 0; i <= p.degree; ++i) p.c[i] = i == k ? odd : i % 2 ? -1.5 : 0.5;
        out.push(p, k == p.degree + 1 ? odd : 0, k == p.degree + 2 ? odd : 2);
      }
    }
    return out;
  }
};

/// Eight lanes of every instruction set give the bits of a single lane, also where columns are not aligned or
/// do not fill the lanes.
TEST_P(RootsInLanes, BitsAreTheSameEverywhere) {
  Columns one = columns(3000);
  const std::size_t all = one.a.size();
  one.solve(kernel().id, Isa::scalar, 0, all);
  Columns wide = one;
  for (const Isa isa : available_isas()) {
    for (const auto& [begin, count] :
         {std::pair{std::size_t{0}, all}, {1, 7}, {3, 8}, {5, 9}, {8, 1}, {2, 23}}) {
      wide.solve(kernel().id, isa, begin, count);
      for (int k = 0; k < kernel().roots; ++k) {
        EXPECT_EQ(std::memcmp(&wide.x[k][0], &one.x[k][begin], count * sizeof(double)), 0) << to_string(isa);
        EXPECT_EQ(wide.x[k][count], -7);
        if (kernel().certified) {
          EXPECT_EQ(std::memcmp(&wide.error[k][0], &one.error[k][begin], count * sizeof(double)), 0);
        }
      }
    }
  }
}

class CertifiedLanes : public RootsInLanes {};

/// Certified lanes against the exact oracle. Clusters are listed once, so those problems count by place only.
TEST_P(CertifiedLanes, MissAndInventNothing) {
  ASSERT_TRUE(kernel().certified);
  int simple = 0;
  for (int c = 0; c < test::kRootClasses; ++c) {
    Columns columns;
    std::vector<RootProblem> problems;
    for (std::uint64_t i = 0; i < 800; ++i) {
      problems.push_back(test::random_problem(static_cast<RootClass>(c), kernel().degree, i + 7000));
      columns.push(problems.back().p, problems.back().a, problems.back().b);
    }
    columns.solve(kernel().id, available_isas().back(), 0, problems.size());
    for (std::size_t i = 0; i < problems.size(); ++i) {
      EXPECT_EQ(columns.unsure[i], 0);
      const RootProblem& q = problems[i];
      const roots::Roots truth = roots::solve(q.p, q.a, q.b), got = columns.answer(i, kernel().roots);
      ASSERT_EQ(got.count, std::min(truth.count, kernel().roots));
      bool clusters = false;
      for (int k = 0; k < got.count; ++k) {
        EXPECT_LE(std::abs(got.root[k].x - truth.root[k].x), got.root[k].error + truth.root[k].error);
        clusters |= truth.root[k].multiplicity > 1;
      }
      if (clusters || kernel().roots < kernel().degree) continue;
      const test::Judgement j = test::judge(q.p, q.a, q.b, got);
      EXPECT_EQ(j.missed + j.invented, 0) << j.what;
      ++simple;
    }
  }
  if (kernel().roots == kernel().degree) {
    EXPECT_GT(simple, 4000);
  }
}

/// Closed forms find roots that are well apart.
TEST_P(RootsInLanes, SeparatedRootsAreFound) {
  Columns columns;
  test::Sequence random(5);
  std::vector<std::vector<double>> truth;
  for (int i = 0; i < 2000; ++i) {
    std::vector<double> roots;
    roots::Polynomial p;
    p.degree = 0;
    p.c[0] = random.uniform(0.5, 2);
    for (int k = 0; k < kernel().degree; ++k) {
      const double r = k + random.uniform(-0.3, 0.3) - 1.5;
      roots.push_back(r);
      p.c[++p.degree] = 0;
      for (int j = p.degree; j >= 0; --j) p.c[j] = (j ? p.c[j - 1] : 0) - r * p.c[j];
    }
    columns.push(p, -8, 8);
    truth.push_back(roots);
  }
  columns.solve(kernel().id, available_isas().back(), 0, truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (int k = 0; k < kernel().roots; ++k) EXPECT_NEAR(columns.x[k][i], truth[i][k], 1e-10);
  }
}

INSTANTIATE_TEST_SUITE_P(Kernels, RootsInLanes, testing::Range(0, 8));
INSTANTIATE_TEST_SUITE_P(Kernels, CertifiedLanes, testing::Range(3, 8));

}  // namespace
}  // namespace oktett::roots_lanes_test
