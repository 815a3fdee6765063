#pragma once
/// \file Rays and hits: one at a time, and as batches of columns.

#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/mesh.h"
#include "core/soa.h"
#include "core/vec3.h"

namespace oktett {

/// The points origin + t * direction with tmin < t <= tmax. The direction need not be of unit length; t
/// counts in its length. 0 <= tmin. A ray with a NaN anywhere, a zero direction or tmax <= tmin hits nothing.
struct Ray {
  Vec3f origin;
  float tmin = 0;
  Vec3f direction;
  float tmax = std::numeric_limits<float>::infinity();
};

/// Where a ray meets a shape. `item` is the primitive's index in the acceleration structure that holds it,
/// counted through all geometries in order; `instance` numbers the chain of instances that leads there (kNoId
/// = none). `u`, `v` are the shape's own parameters (barycentric coordinates of the triangle's second and
/// third corner). item == kNoId is a miss.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  float u = 0, v = 0;
  std::uint32_t item = kNoId;
  std::uint32_t instance = kNoId;

  bool valid() const { return item != kNoId; }
  bool operator==(const Hit&) const = default;
};

/// Borrowed columns of `size` rays, see Ray.
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
  RaySpan part(std::size_t begin, std::size_t count) const {
    RaySpan s = *this;
    for (int k = 0; k < 3; ++k) s.origin[k] += begin, s.direction[k] += begin;
    s.tmin += begin, s.tmax += begin, s.size = count;
    return s;
  }
};

/// Borrowed columns for as many hits, see Hit.
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
  HitSpan part(std::size_t begin, std::size_t count) const {
    return {t + begin, u + begin, v + begin, item + begin, instance + begin, count};
  }
};

/// Owned columns of rays.
struct RayBatch {
  Column<float> origin[3], direction[3], tmin, tmax;

  std::size_t size() const { return tmin.size(); }
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
};

/// Owned columns of hits.
struct HitBatch {
  Column<float> t, u, v;
  Column<std::uint32_t> item, instance;

  std::size_t size() const { return t.size(); }
  void resize_uninitialized(std::size_t n) {
    t.resize_uninitialized(n), u.resize_uninitialized(n), v.resize_uninitialized(n);
    item.resize_uninitialized(n), instance.resize_uninitialized(n);
  }
  Hit operator[](std::size_t i) const { return {t[i], u[i], v[i], item[i], instance[i]}; }
  HitSpan span() { return {t.data(), u.data(), v.data(), item.data(), instance.data(), size()}; }
};

}  // namespace oktett
