#include "accel/compact_node.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "accel/accel_data.h"
#include "accel/query.h"
#include "accel/traverse/inflight/inflight_ray.h"
#include "accel/traverse/node_planes.h"
#include "accel/traverse/trace_counts.h"
#include "core/isa.h"
#include "verify/cases/kernel_cases.h"
#include "verify/oracles/mesh.h"

namespace oktett {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kMax = std::numeric_limits<float>::max();
constexpr NodeLayout kLayouts[] = {NodeLayout::full, NodeLayout::compact};

Box decoded(const CompactNode& node, int child) {
  Box b;
  for (int k = 0; k < 3; ++k)
    b.lo[k] = node_plane(node, 2 * k, child), b.hi[k] = node_plane(node, 2 * k + 1, child);
  return b;
}

/// Checks that boxes are held by what is decoded, and that this is no larger than a step of the grid, with
/// what rounding at the size of the coordinates adds.
void expect_held(const std::vector<Box>& boxes, const char* what) {
  CompactNode node;
  const int count = static_cast<int>(boxes.size());
  set_boxes(node, boxes.data(), count);
  EXPECT_EQ(node.present, (1u << count) - 1);
  Box all;
  for (const Box& b : boxes) all.grow(b);
  for (int i = 0; i < count; ++i) {
    const Box& b = boxes[static_cast<std::size_t>(i)];
    const Box d = decoded(node, i);
    EXPECT_TRUE(d.contains(b)) << what;
    for (int k = 0; k < 3; ++k) {
      const double extent = double(all.hi[k]) - all.lo[k];
      const double size = std::max(std::fabs(double(all.hi[k])), std::fabs(double(all.lo[k])));
      const double step = 2 * extent / 255 + size * 0x1p-22 + 0x1p-126;
      // Beyond half of what floats span, half of the steps are at infinity.
      if (extent > 0x1p126) continue;
      EXPECT_LE(double(b.lo[k]) - d.lo[k], step) << what;
      EXPECT_LE(double(d.hi[k]) - b.hi[k], step) << what;
    }
  }
}

Box sorted_box(const Vec3f& a, const Vec3f& b) { return {min(a, b), max(a, b)}; }

TEST(CompactNode, DecodedBoxesHoldTheOthers) {
  CaseRandom r(1);
  for (int round = 0; round < 20000; ++round) {
    const double scale = r.magnitude(-44, 38), shift = round % 3 == 0 ? r.magnitude(-30, 37) : 0;
    const int count = 1 + static_cast<int>(r.bits() % 8);
    std::vector<Box> boxes;
    for (int i = 0; i < count; ++i) {
      const Vec3d at = r.vector() + Vec3d{1, -1, 0.5} * (shift / scale);
      const double size = r.magnitude(-8, 0);
      const auto corner = [&] { return Vec3f((at + r.vector() * size) * scale); };
      boxes.push_back(sorted_box(corner(), corner()));
      for (int k = 0; k < 3; ++k) {
        Box& b = boxes.back();
        b.lo[k] = std::clamp(b.lo[k], -kMax, kMax), b.hi[k] = std::clamp(b.hi[k], -kMax, kMax);
        if (r.bits() % 4 == 0) b.hi[k] = b.lo[k];  // flat
      }
    }
    expect_held(boxes, "random");
    if (HasFailure()) return;
  }
}

TEST(CompactNode, ExtremeBoxes) {
  const auto cube = [](float lo, float hi) { return Box{{lo, lo, lo}, {hi, hi, hi}}; };
  const float tiny = std::numeric_limits<float>::denorm_min(), least = std::numeric_limits<float>::min();
  expect_held({cube(0, 0)}, "a point");
  expect_held({cube(-0.0f, 0)}, "zeros");
  expect_held({cube(-kMax, kMax)}, "everything");
  expect_held({cube(-kMax, -kMax), cube(kMax, kMax), cube(0, 1)}, "both ends");
  expect_held({cube(-kMax, kMax), cube(kMax / 2, kMax), cube(1, 2)}, "upper half");
  expect_held({cube(0, tiny), cube(tiny, 2 * tiny)}, "denormals");
  expect_held({cube(-least, least), cube(0, tiny)}, "least normals");
  expect_held({cube(1, std::nextafter(1.0f, 2.0f)), cube(1, 1)}, "neighbours");
  expect_held({cube(1e30f, std::nextafter(1e30f, kInf)), cube(1e30f, 1e30f)}, "far neighbours");
  expect_held({cube(0, 255), cube(1, 254), cube(127, 128)}, "whole steps");
  expect_held({cube(0, std::nextafter(255.0f, 256.0f)), cube(1, 2)}, "just above");
}

void expect_planes(const CompactNode& node) {
  using A = ScalarIsa;
  for (int row = 0; row < 6; ++row) {
    alignas(64) float lanes[BvhNode::kWidth];
    node_planes<A>(node, row).store(lanes);
    for (int i = 0; i < BvhNode::kWidth; ++i) EXPECT_EQ(lanes[i], node_plane(node, row, i));
  }
  alignas(16) float powers[4];
  load_powers3<A>(node.exponent).store(powers);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(powers[k], node.scale(k));
  EXPECT_EQ(powers[3], 0.0f);
}

// Every byte, every exponent.
TEST(CompactNode, LanesAreWhatIsDecodedOneByOne) {
  for (int e = 0; e <= 248; ++e) {
    CompactNode node{};
    for (int k = 0; k < 3; ++k) {
      node.origin[k] = static_cast<float>(k - 1) * 1.1f;
      node.exponent[k] = static_cast<std::uint8_t>((e + 83 * k) % 249);
    }
    node.present = 0xff;
    for (int i = 0; i < 48; ++i) (&node.plane[0][0])[i] = static_cast<std::uint8_t>(48 * e + i);
    expect_planes(node);
  }
}

/// Whether the line of `r` meets a box within the ray's range, in extended precision.
bool meets(const Ray& r, const Box& box) {
  long double near = r.tmin, far = r.tmax;
  for (int k = 0; k < 3; ++k) {
    const long double lo = static_cast<long double>(box.lo[k]) - r.origin[k],
                      hi = static_cast<long double>(box.hi[k]) - r.origin[k], d = r.direction[k];
    if (d == 0) {
      if (lo > 0 || hi < 0) return false;
      continue;
    }
    near = std::max(near, std::min(lo / d, hi / d)), far = std::min(far, std::max(lo / d, hi / d));
  }
  return near <= far;
}

// Interleaved rays never form the planes. They must meet every child whose own box they meet, at every scale,
// also if they only touch a corner of it.
TEST(CompactNode, InterleavedRaysMeetWhatTheyShould) {
  constexpr int kRays = 8;
  using A = ScalarIsa;
  CaseRandom r(21);
  int met = 0, more = 0;
  const auto slot = std::make_unique<InflightRay>();
  const auto chunk = std::make_unique<RayChunk<kRays, A>>();
  for (int round = 0; round < 6000; ++round) {
    const double scale = r.magnitude(-10, 10), shift = round % 2 == 0 ? r.magnitude(-2, 4) : 0;
    std::vector<Box> boxes;
    float extent = 0;
    for (int i = 0; i < 8; ++i) {
      const Vec3d at = (r.vector() + Vec3d{1, -0.7, 0.2} * shift) * scale;
      const double size = r.magnitude(-6, 0) * scale;
      boxes.push_back(sorted_box(Vec3f(at), Vec3f(at + r.vector() * size)));
      if (i % 3 == 0) boxes.back().hi.z = boxes.back().lo.z;
      extent = std::max({extent, max_component(abs(boxes.back().lo)), max_component(abs(boxes.back().hi))});
    }
    CompactNode node;
    set_boxes(node, boxes.data(), 8);
    RayBatch rays;
    for (int i = 0; i < kRays; ++i) {
      const Box& b = boxes[r.bits() % 8];
      Vec3f corner;
      for (int k = 0; k < 3; ++k) corner[k] = r.bits() % 2 == 0 ? b.lo[k] : b.hi[k];
      const double far = i % 2 == 0 ? 2 : r.magnitude(0, 5);
      Vec3f from = corner + Vec3f(r.vector() * (scale * far));
      // Exactly in a face or along an edge.
      for (int k = 0; k < 3; ++k)
        if (r.bits() % 4 == 0) from[k] = corner[k];
      Ray ray{from, 0, corner - from, kInf};
      if (i % 3 == 0) ray.direction = ray.direction * static_cast<float>(r.magnitude(-6, 6) / scale);
      rays.push_back(ray);
    }
    chunk->set(rays.span(), 0, extent, true);
    for (int i = 0; i < kRays; ++i) {
      if ((chunk->tame >> i & 1) == 0) continue;
      fill_slot(*slot, *chunk, i, NodeRef::none());
      Simd<float, BvhNode::kWidth, A> near;
      const unsigned found = slot_node<A>(*slot, node, near);
      for (int c = 0; c < 8; ++c) {
        const bool should = meets(rays[static_cast<std::size_t>(i)], boxes[static_cast<std::size_t>(c)]);
        ASSERT_TRUE(!should || (found >> c & 1) != 0) << round << " ray " << i << " child " << c;
        met += should, more += !should && (found >> c & 1) != 0;
      }
    }
  }
  EXPECT_GT(met, 20000);
  EXPECT_LT(more, 2 * met);
}

TriangleMesh soup(int count, std::uint64_t seed, double scale, const Vec3d& shift = {}) {
  TriangleMesh m;
  CaseRandom r(seed);
  for (int i = 0; i < count; ++i) {
    const Vec3d c = r.vector();
    const double size = i % 10 == 0 ? 0.6 : 0.05;
    for (int k = 0; k < 3; ++k) {
      Vec3d p = c + r.vector() * size;
      if (i % 7 == 0) p.z = 0.25;  // flat boxes
      m.indices.push_back(static_cast<std::uint32_t>(m.positions.size()));
      m.positions.push_back(Vec3f(p * scale + shift));
    }
  }
  return m;
}

/// Towards vertices, edges and faces, along axes, and past everything; from near, from far, and with ranges
/// that end at what they aim at.
RayBatch rays_at(const TriangleMesh& m, int count, std::uint64_t seed, double scale, const Vec3d& shift) {
  RayBatch rays;
  CaseRandom r(seed);
  for (int i = 0; i < count; ++i) {
    const std::size_t t = 3 * (r.bits() % m.triangle_count());
    const auto corner = [&](std::size_t k) { return Vec3d(m.positions[m.indices[t + k]]); };
    const double u = i % 3 == 0 ? 0 : r.unit(), v = i % 4 == 0 ? 0 : r.unit() * (1 - u);
    const Vec3d target = corner(0) * (1 - u - v) + corner(1) * u + corner(2) * v;
    Vec3d from = r.vector() * (scale * (i % 5 == 0 ? 40 : 1.5)) + shift;
    if (i / 16 % 3 == 0) from = Vec3d{1.5, 0.5, 1} * scale + shift;  // many from one point
    Ray ray{Vec3f(from), 0, Vec3f(target) - Vec3f(from), i % 6 == 0 ? 1.0f : kInf};
    if (i % 11 == 0) ray.direction[static_cast<int>(r.bits() % 3)] = i % 2 == 0 ? 0.0f : -0.0f;
    if (i % 13 == 0) ray.direction = {0, 0, static_cast<float>(-scale)};
    if (i % 17 == 0) ray.direction = ray.direction / static_cast<float>(scale);
    if (i % 97 == 0) ray.direction.y = std::numeric_limits<float>::quiet_NaN();
    rays.push_back(ray);
  }
  return rays;
}

/// Hits of `other`, in every way of tracing, are those of single rays in `plain`.
int expect_same(const Accel& plain, const Accel& other, const RayBatch& rays, const std::string& what) {
  HitBatch expected, hits;
  expected.resize_uninitialized(rays.size()), hits.resize_uninitialized(rays.size());
  std::vector<std::uint8_t> dark(rays.size());
  closest_hit(plain, rays.span(), expected.span(), Isa::scalar, TraceMode::single);
  int found = 0;
  for (const Isa isa : available_isas()) {
    for (const TraceMode mode :
         {TraceMode::automatic, TraceMode::single, TraceMode::packet4, TraceMode::packet8,
          TraceMode::packet16, TraceMode::beam, TraceMode::interleaved}) {
      closest_hit(other, rays.span(), hits.span(), isa, mode);
      any_hit(other, rays.span(), dark.data(), isa, mode);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        EXPECT_EQ(hits[i], expected[i])
            << what << ' ' << to_string(isa) << " mode " << int(mode) << " ray " << i;
        EXPECT_EQ(dark[i] != 0, expected[i].valid()) << what << ' ' << to_string(isa) << " ray " << i;
        if (testing::Test::HasFailure()) return 0;
        found += hits[i].valid();
      }
    }
    std::vector<Hit> a, b;
    for (std::size_t i = 0; i < rays.size(); i += 7) {
      all_hits(plain, rays[i], a, Isa::scalar), all_hits(other, rays[i], b, isa);
      EXPECT_EQ(a, b) << what << ' ' << to_string(isa) << " ray " << i;
    }
  }
  return found;
}

TEST(CompactNodes, HitsAreThoseOfFullNodes) {
  struct Place {
    double scale;
    Vec3d shift;
  };
  const Place places[] = {
      {1, {}},    {1, {3000, -70000, 5}}, {1e-9, {}}, {1e-20, {}}, {1e-25, {}}, {1e10, {}}, {1e20, {}},
      {1e30, {}}, {1e-3, {1, 1, 1}},      {1e38, {}}};
  for (const Place& p : places)
    for (const BuildQuality quality : {BuildQuality::balanced, BuildQuality::best}) {
      const TriangleMesh m = soup(900, 3, p.scale, p.shift);
      const std::vector<Geometry> geometries = {{MeshGeometry{&m}, {}, kNoId}};
      const auto plain = build_accel(geometries, {quality});
      const auto compact = build_accel(geometries, {quality, true, NodeLayout::compact});
      ASSERT_TRUE(compact->compact);
      EXPECT_EQ(compact->stats.nodes, plain->stats.nodes);
      EXPECT_EQ(compact->stats.node_bytes, plain->stats.nodes * 96);
      EXPECT_GE(compact->stats.sah_cost, plain->stats.sah_cost);
      const RayBatch rays = rays_at(m, 1500, 4, p.scale, p.shift);
      const int found = expect_same(*plain, *compact, rays, "scale " + std::to_string(p.scale));
      if (HasFailure()) return;
      if (p.scale < 1e35) {
        EXPECT_GT(found, 5000) << p.scale;
      }
    }
}

// Instances whose children have nodes of the other layout, closed forms, planes.
TEST(CompactNodes, MixedKindsAndLayouts) {
  const TriangleMesh m = soup(300, 5, 1), textbook = soup(60, 6, 1);
  std::shared_ptr<const Accel> child[2];
  for (int i = 0; i < 2; ++i)
    child[i] = build_accel({{MeshGeometry{&m}, {}, kNoId}}, {BuildQuality::best, true, kLayouts[i]});
  std::vector<Geometry> geometries = {{MeshGeometry{&m}, {}, kNoId}};
  geometries.push_back({MeshGeometry{&textbook, true, TriangleTest::moller_trumbore}, {}, kNoId});
  geometries.push_back({PlaneShape{{0, 0, 1}, -0.7}, {}, kNoId});
  CaseRandom r(7);
  std::vector<Geometry> others = geometries;
  for (int i = 0; i < 90; ++i) {
    const Vec3d c = r.vector();
    const Affine at = Affine::translation(c) * Affine::scaling({0.3, 0.2, 0.1});
    for (std::vector<Geometry>* list : {&geometries, &others}) {
      const auto& inner = child[list == &others ? i / 4 % 2 : 0];
      if (i % 4 == 0)
        list->push_back({SpheresShape{{{c, 0.05}}}, {}, kNoId});
      else if (i % 4 == 1)
        list->push_back({BoxShape{c, c + Vec3d{0.1, 0.1, 0.01}}, {}, kNoId});
      else if (i % 4 == 2)
        list->push_back({DiskShape{c, {0, 0, 1}, 0.1}, {}, kNoId});
      else
        list->push_back({InstanceGeometry{inner}, at, kNoId});
    }
  }
  const auto plain = build_accel(geometries);
  const RayBatch rays = rays_at(m, 1500, 8, 1, {});
  for (const NodeLayout nodes : kLayouts) {
    const auto other = build_accel(others, {BuildQuality::balanced, true, nodes});
    EXPECT_GT(expect_same(*plain, *other, rays, "mixed"), 5000);
  }
}

// Larger boxes are met by all rays that met the smaller ones, and by few others.
TEST(CompactNodes, RaysMeetALittleMore) {
  const TriangleMesh m = make_torus(200, 100).mesh;
  const std::vector<Geometry> geometries = {{MeshGeometry{&m}, {}, kNoId}};
  const auto full = build_accel(geometries);
  const auto compact = build_accel(geometries, {BuildQuality::balanced, true, NodeLayout::compact});
  RayBatch rays, missing;
  CaseRandom r(9);
  for (int i = 0; i < 4000; ++i) {
    const Vec3d from = r.vector() * 3.0, to = r.vector() * 0.9;
    rays.push_back({Vec3f(from), 0, Vec3f(to - from), kInf});
  }
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  closest_hit(*full, rays.span(), hits.span(), Isa::scalar);
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (!hits[i].valid()) missing.push_back(rays[i]);
  const TraceCounts a = trace_counts(*full, missing.span()), b = trace_counts(*compact, missing.span());
  EXPECT_GT(a.blocks, 400u);
  EXPECT_GE(b.nodes, a.nodes);
  EXPECT_GE(b.boxes, a.boxes);
  EXPECT_GE(b.blocks, a.blocks);
  EXPECT_LT(static_cast<double>(b.blocks), 1.15 * static_cast<double>(a.blocks));
  EXPECT_LT(static_cast<double>(b.nodes), 1.15 * static_cast<double>(a.nodes));
}

TEST(CompactNodes, SameForAnyNumberOfThreadsAndWithoutANode) {
  const TriangleMesh m = soup(30000, 10, 1);
  const std::vector<Geometry> geometries = {{MeshGeometry{&m}, {}, kNoId}};
  const auto serial = build_accel(geometries, {BuildQuality::balanced, false, NodeLayout::compact});
  const auto parallel = build_accel(geometries, {BuildQuality::balanced, true, NodeLayout::compact});
  ASSERT_EQ(serial->stats.nodes, parallel->stats.nodes);
  EXPECT_EQ(std::memcmp(serial->compact_nodes.data(), parallel->compact_nodes.data(),
                        serial->stats.nodes * sizeof(CompactNode)),
            0);
  for (const int count : {0, 1, 8, 9}) {
    const TriangleMesh few = soup(count, 11, 1);
    const std::vector<Geometry> one = {{MeshGeometry{&few}, {}, kNoId}};
    const auto plain = build_accel(one),
               compact = build_accel(one, {BuildQuality::fast, true, NodeLayout::compact});
    expect_same(*plain, *compact, rays_at(m, 200, 12, 1, {}), "few");
  }
}

}  // namespace
}  // namespace oktett
