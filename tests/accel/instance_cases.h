#pragma once
/// \file Structures of instances for tests, and what their rays hit by asking each instance by itself.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "accel/accel_data.h"
#include "tests/accel/same_hits.h"
#include "tests/support/limits.h"
#include "verify/cases/kernel_cases.h"

namespace oktett {

using AccelPtr = std::shared_ptr<const Accel>;

/// Every set and mode finds what the scalar code finds. Returns the number of hits.
inline int expect_same_hits(const Accel& accel, const RayBatch& rays) {
  return expect_hits(accel, rays, scalar_hits(accel, rays),
                     {TraceMode::interleaved, TraceMode::automatic, TraceMode::beam, TraceMode::single});
}

/// The ray in the space of an instance's child: in double, rounded to float.
inline Ray inside(const ListedInstance& instance, const Ray& r) {
  Ray ray = r;
  const auto map = [&](const Vec3f& p, int k, double w) {
    const float* m = instance.to_child + 4 * k;
    const double x = p.x, y = p.y, z = p.z, shift = m[3];
    const double linear = (double(m[0]) * x + double(m[1]) * y) + double(m[2]) * z;
    return static_cast<float>(w == 0 ? linear : linear + shift);
  };
  for (int k = 0; k < 3; ++k) ray.origin[k] = map(r.origin, k, 1), ray.direction[k] = map(r.direction, k, 0);
  return ray;
}

/// The nearest hit of a ray with the instances of one list, each asked by itself; of equal ones the first.
inline Hit ask_each(const Accel& accel, const Ray& ray) {
  Hit nearest;
  std::vector<const ListedInstance*> order;
  for (const ListedInstance& k : accel.listed_instances) order.push_back(&k);
  std::ranges::sort(order, {}, &ListedInstance::item);
  for (const ListedInstance* k : order) {
    Hit h = closest_hit(*accel.listed_children[k->child], inside(*k, ray), Isa::scalar);
    if (!h.valid() || (nearest.valid() && h.t >= nearest.t)) continue;
    h.instance = k->first_path + (h.instance + 1);
    nearest = h;
  }
  return nearest;
}

inline TriangleMesh soup(int count, std::uint64_t seed, double size) {
  TriangleMesh m;
  CaseRandom r(seed);
  for (int i = 0; i < count; ++i) {
    const Vec3d c = r.vector();
    for (int k = 0; k < 3; ++k) {
      m.indices.push_back(static_cast<std::uint32_t>(m.positions.size()));
      m.positions.push_back(Vec3f(c + r.vector() * (i % 10 == 0 ? 8 * size : size)));
    }
  }
  return m;
}

inline AccelPtr tree_of(const TriangleMesh& mesh, BuildQuality quality = BuildQuality::balanced) {
  return build_accel({{MeshGeometry{&mesh}, {}, kNoId}}, {quality});
}

inline InstancePlace place(const Affine& to_list, std::uint32_t child) {
  InstancePlace p{{}, child, kNoId};
  to_list.to_rows(p.to_list);
  return p;
}

inline Affine turned(CaseRandom& r, double scale) {
  return Affine::rotation(r.vector() * 180.0) * Affine::scaling(Vec3d{1, 1, 1} * scale);
}

inline void add_instance(std::vector<Geometry>& geometries, const AccelPtr& child, const Affine& at = {}) {
  const Geometry instance{InstanceGeometry{child}, at, kNoId};
  geometries.push_back(instance);
}

/// 3000 instances that overlap, of trees of few triangles, of many, and of triangles in pieces. The meshes
/// live as long as the crowd.
struct Crowd {
  TriangleMesh few = soup(3, 1, 0.5), many = soup(400, 2, 0.1), split = soup(300, 3, 0.2);
  AccelPtr accel;

  Crowd() {
    const AccelPtr in_pieces = tree_of(split, BuildQuality::best);
    EXPECT_TRUE(in_pieces->pieces);
    InstanceList list{{tree_of(few), tree_of(many), in_pieces}, {}};
    CaseRandom r(4);
    for (std::uint32_t k = 0; k < 3000; ++k)
      list.places.push_back(place(Affine::translation(r.vector() * 8.0) * turned(r, 0.3 + r.unit()), k % 3));
    accel = build_accel({{list, {}, kNoId}});
  }
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;
};

/// 60 instances of `mesh`, whose own scale is `scale`, about the origin: mirrored, nearly flat, sheared and
/// unevenly scaled. First one by one and in a list by turns, then those of the list alone.
inline std::pair<AccelPtr, AccelPtr> unusual_maps(const TriangleMesh& mesh, double scale, CaseRandom& r) {
  std::vector<Geometry> geometries;
  InstanceList list{{tree_of(mesh)}, {}};
  for (int k = 0; k < 60; ++k) {
    Affine shape = Affine::scaling(Vec3d{1, 1, 1} / scale);
    if (k % 5 == 1) shape = Affine::scaling({-1, 1, 1}) * shape;
    if (k % 5 == 2) shape = Affine::scaling({1, 1, r.magnitude(-9, 0)}) * shape;
    if (k % 5 == 3)
      shape = Affine::scaling({1, 0.01, 1}) * turned(r, 1) * Affine::scaling({1, 50, 1}) * shape;
    if (k % 5 == 4) shape = Affine::scaling({r.magnitude(-3, 3), 1, r.magnitude(-6, 6)}) * shape;
    const Affine at = Affine::translation(r.vector() * 2.0) * turned(r, 1) * shape;
    if (k % 2 == 0)
      list.places.push_back(place(at, 0));
    else
      add_instance(geometries, list.children[0], at);
  }
  const Geometry listed{list, {}, kNoId};
  geometries.push_back(listed);
  return {build_accel(geometries), build_accel({listed})};
}

/// Compares every `step`-th ray, traced in one mode, with ask_each(); up to `grazing` of them may differ. An
/// instance is displaced by the rounding of the ray in its space, so a ray that touches the bounds of the
/// instance may miss them.
inline void expect_asked_each(const Accel& accel, const RayBatch& rays, std::size_t step, TraceMode mode,
                              int grazing = 0) {
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  closest_hit(accel, rays.span(), hits.span(), default_isa(), mode);
  int different = 0;
  for (std::size_t i = 0; i < rays.size(); i += step)
    different += !same_bits(hits[i], ask_each(accel, rays[i]));
  EXPECT_LE(different, grazing);
}

}  // namespace oktett
