#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <type_traits>
#include <vector>

#include "accel/traverse/inflight/inflight_ray.h"
#include "tests/accel/same_hits.h"
#include "tests/support/limits.h"
#include "tests/support/triangle_cases.h"
#include "verify/cases/kernel_cases.h"

namespace oktett::inflight_test {
namespace {

int expect_same_hits(const TriangleMesh& mesh, const RayBatch& rays) {
  const auto accel = build_accel({{MeshGeometry{&mesh}, {}, kNoId}});
  return expect_hits(*accel, rays, scalar_hits(*accel, rays),
                     {TraceMode::interleaved, TraceMode::single, TraceMode::automatic});
}

/// A case with its triangle once or twice; the two tie.
void add_random_case(TriangleRandom& random, TriangleMesh& mesh, RayBatch& rays, float scale) {
  const TriangleCase c = adversarial_case(random, scale);
  add_case(c, mesh, rays, random.bits() % 8 == 0 ? 2 : 1);
}

class InterleavedScale : public testing::TestWithParam<float> {};

TEST_P(InterleavedScale, AdversarialTrianglesGiveTheSameHits) {
  TriangleRandom random(static_cast<std::uint64_t>(std::ilogb(GetParam()) + 3000));
  TriangleMesh mesh;
  RayBatch rays;
  for (int i = 0; i < 500; ++i) add_random_case(random, mesh, rays, GetParam());
  EXPECT_GT(expect_same_hits(mesh, rays), 500);
}

INSTANTIATE_TEST_SUITE_P(Scales, InterleavedScale,
                         testing::Values(1.0f, 1e-4f, 1e-9f, 1e-12f, 1e-20f, 1e5f, 1e10f, 1e12f, 1e20f));

/// Invalid or unusual rays, by number.
Ray strange_ray(int kind, Ray r) {
  switch (kind) {
    case 0:
      r.origin.y = kNan;
      break;
    case 1:
      r.direction.x = kNan;
      break;
    case 2:
      r.direction = {0, 0, 0};
      break;
    case 3:
      r.origin.z = kInf;
      break;
    case 4:
      r.direction.y = -kInf;
      break;
    case 5:
      r.tmax = r.tmin = 0.5f;
      break;
    case 6:
      r.tmin = -1;
      break;
    case 7:
      r.tmin = kNan;
      break;
    case 8:
      r.tmax = kNan;
      break;
    case 9:
      r.direction = r.direction * 1e-30f;
      break;
    case 10:
      r.direction = r.direction * 1e30f;
      break;
    case 11:
      r.direction = {1e-39f, -1e-39f, r.direction.z};
      break;
    case 12:
      r.direction = {0, -0.0f, r.direction.z};
      break;
    case 13:
      r.direction.x = 1e-20f;
      break;
    case 14:
      r.tmin = -0.0f;
      break;
    case 15:
      r.tmin = 0.9f;
      break;
    case 16:
      r.origin = r.origin * 1e15f;
      r.direction = -r.origin;
      break;
    case 17:
      r.direction = {1e-42f, 1e-43f, 1e-41f};
      break;
    default:
      break;
  }
  return r;
}

// Rays that hit nothing, or that the fast arithmetic is not made for, stand between others.
TEST(Interleaved, StrangeRaysAmongOthers) {
  TriangleRandom random(17);
  TriangleMesh mesh;
  RayBatch soup, rays;
  for (int i = 0; i < 1000; ++i) add_random_case(random, mesh, soup, 1);
  for (std::size_t i = 0; i < soup.size(); ++i)
    rays.push_back(strange_ray(static_cast<int>(random.bits() % 30), soup[i]));
  EXPECT_GT(expect_same_hits(mesh, rays), 500);
}

// Rays along the axes, in and beside the faces of boxes, meet what they meet one by one.
TEST(Interleaved, AxisParallelRaysOnAGrid) {
  TriangleMesh mesh;
  const auto add = [&](const Vec3f& p) {
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    mesh.positions.push_back(p);
  };
  for (int i = 0; i < 400; ++i) {
    const auto x = static_cast<float>(i % 20), y = static_cast<float>(i / 20), z = static_cast<float>(i % 3);
    for (const Vec3f& p : {Vec3f{x, y, z}, Vec3f{x + 1, y, z}, Vec3f{x, y + 1, z}}) add(p);
  }
  RayBatch rays;
  for (int i = 0; i < 41 * 41; ++i) {
    const float x = 0.5f * static_cast<float>(i % 41), y = 0.5f * static_cast<float>(i / 41);
    rays.push_back({{x, y, 5}, 0, {0, -0.0f, -1}, kInf});
    rays.push_back({{x, y, -5}, 0, {1e-45f, 0, 2}, kInf});
    rays.push_back({{-1, y, 1}, 0, {1, 0, 0}, kInf});
  }
  EXPECT_GT(expect_same_hits(mesh, rays), 800);
}

// Batches that fill no place for a ray in flight, some, all and more.
TEST(Interleaved, BatchesOfAnySize) {
  TriangleRandom random(23);
  TriangleMesh mesh;
  RayBatch soup;
  for (int i = 0; i < 300; ++i) add_random_case(random, mesh, soup, 1);
  for (const std::size_t size : {1, 2, 7, 8, 9, 15, 16, 17, 31, 32, 33, 47, 48, 49, 100}) {
    RayBatch rays;
    for (std::size_t i = 0; i < size; ++i) rays.push_back(soup[i]);
    expect_same_hits(mesh, rays);
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

/// The node over eight boxes.
BvhNode node_of(const std::vector<Box>& boxes) {
  BvhNode node;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (int k = 0; k < 3; ++k)
      node.plane[2 * k][i] = boxes[i].lo[k], node.plane[2 * k + 1][i] = boxes[i].hi[k];
  return node;
}

// The fused slab test meets every box that the ray meets, at every scale, also if it only touches a corner.
/// Short rays enter the tree at what the box around them meets. The ends of these all lie on one plane, most
/// of them off by a rounding error in the same direction.
TEST(Interleaved, ShortRaysThatEndOnASurface) {
  CaseRandom random(71);
  for (int axis = 0; axis < 3; ++axis) {
    for (int bundle = 0; bundle < 64; ++bundle) {
      const float height = static_cast<float>(random.sign());
      TriangleMesh mesh;
      for (std::uint32_t i = 0; i < 64; ++i) {
        const auto x = static_cast<float>(i % 8), y = static_cast<float>(i / 8);
        for (const Vec2f& corner : {Vec2f{x, y}, Vec2f{x + 1, y}, Vec2f{x, y + 1}}) {
          Vec3f p;
          p[axis] = height, p[(axis + 1) % 3] = corner.x, p[(axis + 2) % 3] = corner.y;
          mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
          mesh.positions.push_back(p);
        }
      }
      const auto accel = build_accel({{MeshGeometry{&mesh}, {}, kNoId}});
      const float start = height + static_cast<float>(random.magnitude(-1, 5));
      std::vector<Ray> rays(256);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        rays[i].origin[axis] = start, rays[i].direction[axis] = -1;
        rays[i].origin[(axis + 1) % 3] = static_cast<float>(i % 8) + 0.25f;
        rays[i].origin[(axis + 2) % 3] = static_cast<float>(i / 8 % 8) + 0.25f;
      }
      std::vector<Hit> hits(rays.size());
      closest_hit(*accel, rays, hits);
      RayBatch batch;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        rays[i].tmax = hits[i].t;
        batch.push_back(rays[i]);
      }
      std::vector<std::uint8_t> occluded(rays.size());
      for (const Isa isa : available_isas()) {
        any_hit(*accel, batch.span(), occluded.data(), isa, TraceMode::interleaved);
        EXPECT_EQ(std::count(occluded.begin(), occluded.end(), 1), 256)
            << to_string(isa) << " axis " << axis << " height " << height << " from " << start;
      }
    }
  }
}

TEST(Interleaved, NodesMissNoBox) {
  constexpr int kRays = 8;
  using A = ScalarIsa;
  CaseRandom r(21);
  int met = 0, more = 0;
  const auto inflight = std::make_unique<InflightRay>();
  const auto chunk = std::make_unique<RayChunk<kRays, A>>();
  for (int round = 0; round < 6000; ++round) {
    const double scale = r.magnitude(-10, 10), shift = round % 2 == 0 ? r.magnitude(-2, 4) : 0;
    std::vector<Box> boxes;
    float extent = 0;
    for (int i = 0; i < 8; ++i) {
      const Vec3d at = (r.vector() + Vec3d{1, -0.7, 0.2} * shift) * scale;
      const double size = r.magnitude(-6, 0) * scale;
      const Vec3f a(at), b(at + r.vector() * size);
      boxes.push_back({min(a, b), max(a, b)});
      if (i % 3 == 0) boxes.back().hi.z = boxes.back().lo.z;
      // So near to the origin that the distance from there is less than what the scene's size leaves unsure.
      if (i % 4 == 1) {
        const auto beside = static_cast<float>(std::ldexp(scale, -40 - static_cast<int>(r.bits() % 30)));
        boxes.back().lo.x = boxes.back().hi.x = beside;
      }
      extent = std::max({extent, max_component(abs(boxes.back().lo)), max_component(abs(boxes.back().hi))});
    }
    const BvhNode node = node_of(boxes);
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
      Vec3f direction = corner - from;
      if (b.lo.x == b.hi.x && r.bits() % 2 == 0) {
        from = b.lo + (b.hi - b.lo) * static_cast<float>(r.unit()), from.x = 0;
        direction = Vec3f(r.vector() * scale), direction.x = std::copysign(direction.x, b.lo.x);
      }
      Ray ray{from, 0, direction, kInf};
      if (i % 3 == 0) ray.direction = ray.direction * static_cast<float>(r.magnitude(-6, 6) / scale);
      rays.push_back(ray);
    }
    chunk->set(rays.span(), 0, extent);
    for (int i = 0; i < kRays; ++i) {
      if ((chunk->tame >> i & 1) == 0) continue;
      start_ray(*inflight, *chunk, i, NodeRef::none(), true);
      Simd<float, BvhNode::kWidth, A> near;
      const unsigned found = node_inflight<A>(*inflight, node, near);
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

// Faces so near to where rays begin that the way there is less than what the scene's size leaves unsure.
TEST(Interleaved, FacesRightBeforeTheOrigin) {
  TriangleRandom random(43);
  for (const int exponent : {-30, -36, -40}) {
    const float beside = std::ldexp(1.0f, exponent);
    TriangleMesh mesh;
    const auto add = [&](const Vec3f& p) {
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(p);
    };
    RayBatch rays;
    for (int i = 0; i < 400; ++i) {
      const auto y = static_cast<float>(i % 20) - 10, z = static_cast<float>(i / 20) - 10;
      add({beside, y, z}), add({beside, y + 0.75f, z}), add({beside, y, z + 0.75f});
      Vec3f direction = random.vector();
      direction.x = std::abs(direction.x) + 0.1f;
      rays.push_back({{0, y + 0.25f, z + 0.25f}, 0, direction, kInf});
    }
    const auto accel = build_accel({{MeshGeometry{&mesh}, {}, kNoId}});
    const HitBatch expected = scalar_hits(*accel, rays);
    for (std::size_t i = 0; i < rays.size(); ++i)
      EXPECT_NEAR(expected[i].t, beside / rays[i].direction.x, 1e-14) << exponent << " ray " << i;
    EXPECT_EQ(
        expect_hits(*accel, rays, expected,
                    {TraceMode::interleaved, TraceMode::single, TraceMode::packet8, TraceMode::automatic}),
        400);
  }
}

/// Rays that begin far from each other prefetch a tree that is larger than the cache of a core.
TEST(Interleaved, ScatteredRaysPrefetchAndFindTheSameHits) {
  TriangleRandom random(41);
  TriangleMesh mesh;
  while (mesh.positions.size() < 3 * 60000) {
    const Vec3f at = random.vector();
    for (int k = 0; k < 3; ++k) {
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(at + random.vector() * 0.02f);
    }
  }
  RayBatch scattered, neighbours;
  for (int i = 0; i < 1500; ++i) {
    const Vec3f from = random.vector() * 1.5f, to = random.vector();
    scattered.push_back({from, 0, to - from, i % 3 == 0 ? 1.0f : kInf});
    neighbours.push_back({Vec3f{1.5f, 0.05f * random.sign(), 0}, 0, to, kInf});
  }
  const auto accel = build_accel({{MeshGeometry{&mesh}, {}, kNoId}});
  ASSERT_GT(tree_bytes(*accel), kPrefetchScatteredBytes);
  EXPECT_TRUE(pays_to_prefetch(*accel, scattered.span()));
  EXPECT_FALSE(pays_to_prefetch(*accel, neighbours.span()));
  EXPECT_FALSE(pays_to_prefetch(*accel, scattered.span().part(0, 1)));
  for (const RayBatch& rays : {scattered, neighbours})
    EXPECT_GT(expect_hits(*accel, rays, scalar_hits(*accel, rays), {TraceMode::interleaved}), 200);

  TriangleMesh small;
  for (std::uint32_t k = 0; k < 3; ++k)
    small.indices.push_back(k), small.positions.push_back(random.vector());
  EXPECT_FALSE(pays_to_prefetch(*build_accel({{MeshGeometry{&small}, {}, kNoId}}), scattered.span()));
  for (int k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < scattered.size(); ++i) scattered.origin[k][i] = kNan;
  EXPECT_FALSE(are_scattered(scattered.span(), Box{{0, 0, 0}, {1, 1, 1}}));
}

}  // namespace
}  // namespace oktett::inflight_test
