/// \file What kernels/exact/surfaces.def lists, against what there is.

#include <gtest/gtest.h>

#include <map>
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

/// A solid's inside is where its oracle is negative. Points so near to the surface that a small step changes
/// the oracle's sign are left out.
TEST(SurfaceList, InsideIsWhereTheOracleIsNegative) {
  CaseRandom random(8);
  std::map<std::string, int> within, beyond;
  for (int round = 0; round < 12; ++round)
    for (const ExactOracle& oracle : draw_exact_oracles(random)) {
      const ExactOps& ops = exact_ops(kind_of(oracle.shape.form));
      const auto pool = ops.make_pool();
      ops.add(*pool, oracle.shape, {}, 0);
      if (pool->frames.empty() || oracle.where || is_open(oracle.shape)) continue;
      const Vec3d middle = (oracle.lo + oracle.hi) * 0.5, half = (oracle.hi - oracle.lo) * 0.5;
      for (int i = 0; i < 60; ++i) {
        const Vec3d p = middle + half * random.vector() * 1.1;
        const bool truth = oracle.f(Vec3l(p)) < 0;
        bool sure = true;
        for (int k = 0; k < 6; ++k) {
          Vec3d q = p;
          q[k / 2] += (k % 2 == 0 ? 1e-5 : -1e-5) * max_component(half);
          sure &= (oracle.f(Vec3l(q)) < 0) == truth;
        }
        if (!sure) continue;
        ++(truth ? within : beyond)[ops.name];
        EXPECT_EQ(ops.inside(*pool, 0, pool->frames[0].to_own.point(p)), truth)
            << oracle.name << " at " << p.x << " " << p.y << " " << p.z;
      }
    }
  for (const Listed& line : kLines) {
    EXPECT_GT(within[line.name], 10) << line.name;
    EXPECT_GT(beyond[line.name], 10) << line.name;
  }
}

/// A box without thickness along any axis holds no surface.
TEST(SurfaceList, FlatBoxesHoldNothing) {
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d lo{-1, -1, -1}, hi{1, 1, 1};
    hi[axis] = lo[axis] = 0.25;
    PolynomialShape polynomial;
    polynomial.terms = {{2, 0, 0, 1}, {0, 2, 0, 1}, {0, 0, 2, 1}, {0, 0, 0, -1}};
    polynomial.lo = lo, polynomial.hi = hi;
    BlobShape blob{{{}}};
    blob.bounded = true, blob.lo = lo, blob.hi = hi;
    for (const ExactForm& form : {ExactForm(polynomial), ExactForm(blob)}) {
      const ExactOps& ops = exact_ops(kind_of(form));
      const auto pool = ops.make_pool();
      ops.add(*pool, {form}, {}, 0);
      EXPECT_TRUE(pool->frames.empty()) << ops.name << " along " << axis;
    }
  }
}

}  // namespace oktett::surface_list_test
