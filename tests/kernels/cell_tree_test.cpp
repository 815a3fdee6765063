#include "kernels/exact/cell_tree.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <random>

#include "kernels/fields/blobtree.h"
#include "kernels/fields/metaballs.h"
#include "tests/support/sanitizers.h"

namespace oktett::cell_tree_test {
namespace {

MetaballsShape many_balls() {
  std::mt19937 random(5);
  const auto unit = [&] { return (random() + 0.5) / 4294967296.0; };
  MetaballsShape s;
  for (int i = 0; i < 500; ++i)
    s.balls.push_back({{8 * unit(), 8 * unit(), 8 * unit()}, 0.6 + 0.4 * unit(), unit() < 0.2 ? -0.5 : 1.0});
  return s;
}

BlobTreeShape many_segments() {
  std::mt19937 random(6);
  const auto unit = [&] { return (random() + 0.5) / 4294967296.0; };
  BlobTreeShape s;
  for (std::uint32_t i = 0; i < 100; ++i) {
    const Vec3d from{5 * unit(), 5 * unit(), 5 * unit()};
    FieldElement e;
    e.skeleton = SegmentSkeleton{from, from + Vec3d{unit(), unit(), unit()}};
    e.potential.scale = 0.7;
    s.elements.push_back(e);
    s.blends.push_back({Blend::Op::element, i, 0});
  }
  s.blends.push_back({Blend::Op::sum, 0, 100});
  return s;
}

template <class S, class Shape>
typename S::Pool pool_of(const Shape& shape, std::size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  typename S::Pool pool;
  S::add(pool, shape, {});
  S::add(pool, shape, {Affine::translation({20, 0, 0}), 1});
  return pool;
}

template <class S, class Shape>
void expect_same_for_any_threads(const Shape& shape) {
  const auto one = pool_of<S>(shape, 1);
  ASSERT_GT(one.cells.size(), 200u);
  for (int round = 0; round < (test::kSanitized ? 1 : 5); ++round) {
    const auto four = pool_of<S>(shape, 4);
    EXPECT_EQ(one.tree.lists, four.tree.lists);
    ASSERT_EQ(one.tree.nodes.size(), four.tree.nodes.size());
    for (std::size_t i = 0; i < one.tree.nodes.size(); ++i) {
      const CellNode &a = one.tree.nodes[i], &b = four.tree.nodes[i];
      ASSERT_TRUE(a.split == b.split && a.first == b.first && a.second == b.second && a.kind == b.kind) << i;
    }
    ASSERT_EQ(one.cells.size(), four.cells.size());
    for (std::size_t i = 0; i < one.cells.size(); ++i) {
      const ExactCell &a = one.cells[i], &b = four.cells[i];
      ASSERT_TRUE(a.lo == b.lo && a.hi == b.hi && a.element == b.element && a.begin == b.begin &&
                  a.count == b.count)
          << i;
    }
  }
}

TEST(CellTree, TheSameForAnyNumberOfThreads) {
  expect_same_for_any_threads<Metaballs>(many_balls());
  expect_same_for_any_threads<BlobTree>(many_segments());
}

/// The leaf of a point lists every ball that the point is in.
TEST(CellTree, LeavesListWhatMatters) {
  const MetaballsShape shape = many_balls();
  const auto pool = pool_of<Metaballs>(shape, 4);
  std::mt19937 random(7);
  const auto unit = [&] { return (random() + 0.5) / 4294967296.0; };
  int leaves = 0;
  for (int k = 0; k < 5000; ++k) {
    for (std::size_t element = 0; element < 2; ++element) {
      const Vec3d p{2 * unit() - 1, 2 * unit() - 1, 2 * unit() - 1};
      const MetaballsElement& e = pool.elements[element];
      const CellNode& node = pool.tree.leaf_at(e.root, p);
      if (node.kind != CellNode::Kind::leaf) continue;
      ++leaves;
      const auto begin = pool.tree.lists.begin() + node.first, end = begin + node.second;
      for (std::uint32_t i = e.begin; i < e.begin + e.count; ++i) {
        const Vec3d d = p - pool.balls[i].center;
        if (dot(d, d) < pool.balls[i].square) {
          ASSERT_NE(std::find(begin, end, i), end);
        }
      }
    }
  }
  EXPECT_GT(leaves, 1000);
}

FieldElement thin(const Skeleton& skeleton, double radius) {
  FieldElement e;
  e.skeleton = skeleton;
  e.potential.scale = radius;
  return e;
}

BlobTreeShape sum_of(const std::vector<FieldElement>& elements) {
  BlobTreeShape s;
  s.elements = elements;
  for (std::uint32_t i = 0; i < elements.size(); ++i) s.blends.push_back({Blend::Op::element, i, 0});
  s.blends.push_back({Blend::Op::sum, 0, static_cast<std::uint32_t>(elements.size())});
  return s;
}

/// The number of cells follows from that of the elements, however small these are beside their distances.
TEST(CellTree, CellsDoNotGrowWithTheRatioOfLengths) {
  for (const double length : {65536.0, 1e9, 1e15}) {
    if (test::kSanitized && length > 1e5) break;  // takes minutes
    const std::vector<BlobTreeShape> trees{
        sum_of({thin(SegmentSkeleton{{0, 0, 0}, {length, 0, 0}}, 0.3), thin(PointSkeleton{}, 1)}),
        sum_of({thin(SegmentSkeleton{{0, 0, 0}, {length, 0.3 * length, 0.2 * length}}, 0.3),
                thin(PolygonSkeleton{{{0, 0, 0}, {length, 0, 0}, {0, length, 0}}}, 1e-3),
                thin(EllipsoidSkeleton{{0, 0, 0}, {length, 1, 1e-3}, {10, 20, 30}}, 1)})};
    for (const BlobTreeShape& tree : trees) {
      BlobTree::Pool pool;
      BlobTree::add(pool, tree, {});
      EXPECT_FALSE(pool.cells.empty()) << length;
      EXPECT_LT(pool.cells.size(), 100000u) << length;
      EXPECT_LT(pool.tree.nodes.size(), 400000u) << length;
    }
    Metaballs::Pool pool;
    MetaballsShape balls{0.5, {{{0, 0, 0}, length, 1}}};
    for (int i = 0; i < 50; ++i) balls.balls.push_back({{0.01 * i * length, 0, 0}, 1e-3, i % 2 ? 1.0 : -1.0});
    Metaballs::add(pool, balls, {});
    EXPECT_FALSE(pool.cells.empty()) << length;
    EXPECT_LT(pool.cells.size(), 200000u) << length;
  }
}

// Also where larger cells must do, the result does not depend on how threads share the work.
TEST(CellTree, LargerCellsAreTheSameForAnyNumberOfThreads) {
  std::vector<FieldElement> elements;
  const int count = static_cast<int>(test::cases(200));
  for (int i = 0; i < count; ++i)
    elements.push_back(thin(SegmentSkeleton{{0, 0.5 * i, 0}, {1e5, 0.3 * i, 0.1 * i * i}}, 0.4));
  expect_same_for_any_threads<BlobTree>(sum_of(elements));
}

}  // namespace
}  // namespace oktett::cell_tree_test
