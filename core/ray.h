#pragma once
/// \file Rays and hits: one at a time, and as batches of columns.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/soa.h"
#include "core/vec3.h"

namespace oktett {

/// The points origin + t direction with tmin < t <= tmax. t counts in lengths of the direction, which need
/// not be 1. A ray with a NaN anywhere, a zero direction or tmax <= tmin hits nothing.
struct Ray {
  Vec3f origin;
  float tmin = 0;  ///< >= 0
  Vec3f direction;
  float tmax = std::numeric_limits<float>::infinity();
};

/// Where a ray meets a shape, or a miss: what the members are set to here.
struct Hit {
  float t = std::numeric_limits<float>::infinity();  ///< the hit is at origin + t direction
  float u = 0, v = 0;  ///< of a triangle: barycentric coordinates of its second and third corner
  /// The primitive's number in the acceleration structure that holds it, counted through all geometries in
  /// order.
  std::uint32_t item = kNoId;
  /// The number of the chain of instances that leads to that structure; kNoId if there is none.
  std::uint32_t instance = kNoId;

  /// False for a miss.
  bool valid() const { return item != kNoId; }
  bool operator==(const Hit&) const = default;
};

/// Borrowed columns of `size` rays: component k of ray i's origin is origin[k][i], and so on. They need no
/// alignment.
struct RaySpan {
  const float* origin[3] = {};
  const float* direction[3] = {};
  const float* tmin = nullptr;
  const float* tmax = nullptr;
  std::size_t size = 0;

  Ray operator[](std::size_t i) const {
    return {{origin[0][i], origin[1][i], origin[2][i]},
            tmin[i],
            {direction[0][i], direction[1][i], direction[2][i]},
            tmax[i]};
  }
  /// Rays `begin` to `begin + count - 1`.
  RaySpan part(std::size_t begin, std::size_t count) const {
    RaySpan s = *this;
    for (int k = 0; k < 3; ++k) s.origin[k] += begin, s.direction[k] += begin;
    s.tmin += begin, s.tmax += begin, s.size = count;
    return s;
  }
};

/// Borrowed columns of `size` hits.
struct HitSpan {
  float* t = nullptr;
  float* u = nullptr;
  float* v = nullptr;
  std::uint32_t* item = nullptr;
  std::uint32_t* instance = nullptr;
  std::size_t size = 0;

  Hit operator[](std::size_t i) const { return {t[i], u[i], v[i], item[i], instance[i]}; }
  void set(std::size_t i, const Hit& h) const {
    t[i] = h.t, u[i] = h.u, v[i] = h.v, item[i] = h.item, instance[i] = h.instance;
  }
  /// Hits `begin` to `begin + count - 1`.
  HitSpan part(std::size_t begin, std::size_t count) const {
    return {t + begin, u + begin, v + begin, item + begin, instance + begin, count};
  }
};

/// Owned columns of rays, all of the same size.
struct RayBatch {
  Column<float> origin[3], direction[3], tmin, tmax;

  std::size_t size() const { return tmin.size(); }
  /// Rays that are new hold no defined value.
  void resize_uninitialized(std::size_t n) {
    for (int k = 0; k < 3; ++k) origin[k].resize_uninitialized(n), direction[k].resize_uninitialized(n);
    tmin.resize_uninitialized(n), tmax.resize_uninitialized(n);
  }
  void set(std::size_t i, const Ray& r) {
    for (int k = 0; k < 3; ++k) origin[k][i] = r.origin[k], direction[k][i] = r.direction[k];
    tmin[i] = r.tmin, tmax[i] = r.tmax;
  }
  void push_back(const Ray& r) {
    for (int k = 0; k < 3; ++k) origin[k].push_back(r.origin[k]), direction[k].push_back(r.direction[k]);
    tmin.push_back(r.tmin), tmax.push_back(r.tmax);
  }
  Ray operator[](std::size_t i) const { return span()[i]; }
  RaySpan span() const {
    RaySpan s;
    for (int k = 0; k < 3; ++k) s.origin[k] = origin[k].data(), s.direction[k] = direction[k].data();
    s.tmin = tmin.data(), s.tmax = tmax.data(), s.size = size();
    return s;
  }
  operator RaySpan() const { return span(); }
};

/// Owned columns of hits, all of the same size.
struct HitBatch {
  Column<float> t, u, v;
  Column<std::uint32_t> item, instance;

  std::size_t size() const { return t.size(); }
  /// Hits that are new hold no defined value.
  void resize_uninitialized(std::size_t n) {
    t.resize_uninitialized(n), u.resize_uninitialized(n), v.resize_uninitialized(n);
    item.resize_uninitialized(n), instance.resize_uninitialized(n);
  }
  Hit operator[](std::size_t i) const { return {t[i], u[i], v[i], item[i], instance[i]}; }
  HitSpan span() { return {t.data(), u.data(), v.data(), item.data(), instance.data(), size()}; }
  operator HitSpan() { return span(); }
};

/// Every hit of each ray of a batch.
struct HitLists {
  std::vector<Hit> hits;           ///< those of ray 0, nearest first, then those of ray 1, and so on
  std::vector<std::size_t> begin;  ///< where in `hits` those of each ray begin; one more than there are rays

  /// The hits of ray i, nearest first.
  std::span<const Hit> of_ray(std::size_t i) const {
    return {hits.data() + begin[i], begin[i + 1] - begin[i]};
  }
};

}  // namespace oktett
