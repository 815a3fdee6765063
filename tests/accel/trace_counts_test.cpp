#include "accel/traverse/trace_counts.h"

#include <gtest/gtest.h>

#include "accel/accel_data.h"
#include "tests/support/limits.h"
#include "verify/cases/kernel_cases.h"
#include "verify/oracles/mesh.h"

namespace oktett::trace_counts_test {
namespace {

RayBatch random_rays(int count) {
  RayBatch rays;
  CaseRandom r(1);
  for (int i = 0; i < count; ++i) rays.push_back({Vec3f(r.vector() * 3.0), 0, Vec3f(r.vector()), kInf});
  return rays;
}

// A ray that hits nothing visits exactly the nodes and blocks whose boxes it meets, since boxes nest: a loop
// over all boxes, without a tree, must find as many.
TEST(TraceCounts, MissingRaysVisitAllBoxesThatTheyMeet) {
  const TriangleMesh mesh = make_torus(60, 30).mesh;
  const auto accel = build_accel({{MeshGeometry{&mesh}, {}, kNoId}});
  RayBatch rays = random_rays(3000), missing;
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  closest_hit(*accel, rays.span(), hits.span(), Isa::scalar);
  TraceCounts expected;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (hits[i].valid()) continue;
    missing.push_back(rays[i]);
    const Ray r = rays[i];
    ++expected.rays, ++expected.nodes;  // the root
    for (std::size_t n = 0; n < accel->stats.nodes; ++n)
      for (int c = 0; c < BvhNode::kWidth; ++c) {
        const BvhNode& node = accel->nodes[n];
        if (node.child[c].is_none()) continue;
        double near = 0, far = kInf;
        for (int k = 0; k < 3; ++k) {
          double a = (double(node.plane[2 * k][c]) - r.origin[k]) / r.direction[k];
          double b = (double(node.plane[2 * k + 1][c]) - r.origin[k]) / r.direction[k];
          if (a > b) std::swap(a, b);
          near = std::max(near, a), far = std::min(far, b);
        }
        if (near > far) continue;
        ++expected.boxes;
        ++(node.child[c].is_leaf() ? expected.blocks : expected.nodes);
        if (node.child[c].is_leaf()) expected.triangles += node.child[c].triangle_count();
      }
  }
  ASSERT_GT(missing.size(), 500u);
  const TraceCounts counts = trace_counts(*accel, missing.span());
  EXPECT_EQ(counts.rays, expected.rays);
  EXPECT_EQ(counts.nodes, expected.nodes);
  EXPECT_EQ(counts.boxes, expected.boxes);
  EXPECT_EQ(counts.blocks, expected.blocks);
  EXPECT_EQ(counts.triangles, expected.triangles);
  EXPECT_EQ(counts.hits, 0u);
  EXPECT_GT(counts.blocks, 100u);
}

TEST(TraceCounts, HitsEndTheWalk) {
  const TriangleMesh mesh = make_icosphere(5).mesh;
  const auto accel = build_accel({{MeshGeometry{&mesh}, {}, kNoId}});
  RayBatch short_rays, long_rays;
  CaseRandom r(2);
  for (int i = 0; i < 500; ++i) {
    const Vec3f from = Vec3f(normalize(r.vector()) * 3.0), towards = Vec3f(r.vector() * 0.3);
    long_rays.push_back({from, 0, towards - from, kInf});
    short_rays.push_back({from, 0, towards - from, 0.1f});
  }
  const TraceCounts hit = trace_counts(*accel, long_rays.span());
  EXPECT_EQ(hit.hits, 500u);
  // Front-to-back the far side of the sphere is not reached: one leaf or a few at the near side.
  EXPECT_LT(hit.blocks, 500u * 4);
  EXPECT_GE(hit.blocks, 500u);
  const TraceCounts none = trace_counts(*accel, short_rays.span());
  EXPECT_EQ(none.hits, 0u);
  EXPECT_EQ(none.blocks, 0u);
}

TEST(TraceCounts, OtherShapesAndInstancesAreCounted) {
  const auto ball = build_accel({{SpheresShape{{{{0, 0, 0}, 1.0}}}, {}, kNoId}});
  const auto accel = build_accel({{InstanceGeometry{ball}, Affine::translation({0, 0, 5}), kNoId},
                                  {InstanceGeometry{ball}, Affine::translation({0, 0, 50}), kNoId},
                                  {PlaneShape{{0, 0, 1}, -10}, {}, kNoId}});
  RayBatch rays;
  rays.push_back({{0, 0, 0}, 0, {0, 0, 1}, kInf});   // stops at the first ball
  rays.push_back({{0, 0, 0}, 0, {0, 0, -1}, kInf});  // meets the plane
  rays.push_back({{0, 0, 0}, 0, {0, 0, 0}, kInf});   // no ray at all
  const TraceCounts counts = trace_counts(*accel, rays.span());
  EXPECT_EQ(counts.rays, 3u);
  EXPECT_EQ(counts.hits, 2u);
  EXPECT_EQ(counts.instances, 1u);
  EXPECT_EQ(counts.other, 3u);  // the plane twice, a ball once
  EXPECT_EQ(counts.triangles, 0u);
}

}  // namespace
}  // namespace oktett::trace_counts_test
