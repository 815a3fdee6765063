/// \file What kernels/exact/surfaces.def lists, against what there is.

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "kernels/exact_ops.h"
#include "verify/oracles/exact.h"

namespace oktett::surface_list_test {
namespace {

struct Listed {
  const char* name;
  Kind kind;
  ExactForm form;
};

const Listed kLines[] = {
#define SURFACE(Type, name) {#name, Kind::name, Type##Shape{}},
#include "kernels/exact/surfaces.def"
#undef SURFACE
};

}  // namespace

/// A line is one kind, one alternative of ExactForm and one table of functions.
TEST(SurfaceList, KindsFormsAndTablesAgree) {
  EXPECT_EQ(std::size(kLines), std::variant_size_v<ExactForm::variant>);
  std::set<Kind> kinds;
  for (const Listed& line : kLines) {
    EXPECT_TRUE(kinds.insert(line.kind).second) << line.name;
    EXPECT_EQ(kind_of(line.form), line.kind) << line.name;
    EXPECT_STREQ(exact_ops(line.kind).name, line.name);
    EXPECT_GT(exact_ops(line.kind).most_crossings, 0) << line.name;
    EXPECT_TRUE(exact_ops(line.kind).make_pool()->cells.empty()) << line.name;
  }
}

TEST(SurfaceList, EveryKindIsOfOneSort) {
  std::size_t exact = 0;
  for (int k = 0; k < kKinds; ++k) {
    const auto kind = static_cast<Kind>(k);
    exact += is_exact(kind);
    const int sorts = is_closed_form(kind) + is_exact(kind) + holds_instances(kind) +
                      (kind == Kind::triangle) + (kind == Kind::csg);
    EXPECT_EQ(sorts, 1) << k;
  }
  EXPECT_EQ(exact, std::size(kLines));
}

/// Each surface is among the cases of verify/, and what its traits say holds for what its shapes become.
TEST(SurfaceList, EverySurfaceIsVerifiedAndKeepsItsTraits) {
  std::set<std::string> verified;
  CaseRandom random(7);
  for (int round = 0; round < 4; ++round)
    for (const ExactOracle& oracle : draw_exact_oracles(random)) {
      const ExactOps& ops = exact_ops(kind_of(oracle.shape.form));
      const auto pool = ops.make_pool();
      ops.add(*pool, oracle.shape, {}, 5);
      if (pool->frames.empty()) continue;
      verified.insert(ops.name);
      EXPECT_EQ(pool->frames[0].item, 5u) << ops.name;
      EXPECT_GE(pool->cells.size(), 1u) << ops.name;
      if (ops.one_cell) {
        EXPECT_EQ(pool->cells.size(), 1u) << ops.name;
      }
      EXPECT_GE(ops.bytes(*pool), sizeof(ExactFrame) + sizeof(ExactCell)) << ops.name;
    }
  for (const Listed& line : kLines) EXPECT_TRUE(verified.contains(line.name)) << line.name;
}

}  // namespace oktett::surface_list_test
