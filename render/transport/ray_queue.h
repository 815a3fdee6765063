#pragma once
/// \file Queues of rays to trace, each with the sample that it belongs to.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/ray.h"
#include "core/soa.h"
#include "core/vec3.h"
#include "render/dielectric_stack.h"
#include "render/insides.h"
#include "render/light/light_sample.h"
#include "render/scene.h"
#include "render/straight_light.h"

namespace oktett {

struct ColorColumn {
  Column<float> part[3];  ///< red, green, blue

  std::size_t size() const { return part[0].size(); }
  bool empty() const { return part[0].empty(); }
  /// Colours that are new hold no defined value.
  void resize_uninitialized(std::size_t n) {
    for (Column<float>& p : part) p.resize_uninitialized(n);
  }
  /// Sets the first `count` colours.
  void fill(std::size_t count, const Color& color) {
    for (int k = 0; k < 3; ++k) std::fill_n(part[k].data(), count, color[k]);
  }
  Color operator[](std::size_t i) const { return {part[0][i], part[1][i], part[2][i]}; }
  void set(std::size_t i, const Color& color) {
    for (int k = 0; k < 3; ++k) part[k][i] = color[k];
  }
  void add(std::size_t i, const Color& color) {
    for (int k = 0; k < 3; ++k) part[k][i] += color[k];
  }
  void push_back(const Color& color) {
    for (int k = 0; k < 3; ++k) part[k].push_back(color[k]);
  }
};

/// Rays of unit direction with their state, in columns. Clearing a queue keeps its memory.
struct RayQueue {
  RayBatch rays;
  Column<std::uint32_t> sample;      ///< index into the wavefront's samples
  ColorColumn throughput;            ///< factor on the light that the ray finds
  Column<float> distance;            ///< length of the path up to the ray's origin
  Column<std::uint8_t> bounces;      ///< reflections and refractions so far
  Column<std::uint8_t> from_camera;  ///< 1 for camera rays and their straight continuations through holes
  /// What other rays are for. Set only if RenderContext::bounces_differ.
  Column<RayKind> kind;
  Column<Insides> insides;  ///< the solids around the ray. Set only if RenderContext::tracks_insides.

  std::size_t size() const { return sample.size(); }
  bool empty() const { return sample.empty(); }

  void clear() { resize_uninitialized(0); }
  void resize_uninitialized(std::size_t n) {
    rays.resize_uninitialized(n);
    sample.resize_uninitialized(n), throughput.resize_uninitialized(n), distance.resize_uninitialized(n);
    bounces.resize_uninitialized(n), from_camera.resize_uninitialized(n), kind.resize_uninitialized(n);
    insides.resize_uninitialized(n);
  }

  /// Adds the rays of another queue.
  void append(const RayQueue& other) {
    const std::size_t first = size();
    resize_uninitialized(first + other.size());
    const auto copy = [&](const auto& from, auto& to) {
      std::copy_n(from.data(), other.size(), to.data() + first);
    };
    for (int k = 0; k < 3; ++k) {
      copy(other.rays.origin[k], rays.origin[k]), copy(other.rays.direction[k], rays.direction[k]);
      copy(other.throughput.part[k], throughput.part[k]);
    }
    copy(other.rays.tmin, rays.tmin), copy(other.rays.tmax, rays.tmax), copy(other.sample, sample);
    copy(other.distance, distance), copy(other.bounces, bounces), copy(other.from_camera, from_camera);
    copy(other.kind, kind), copy(other.insides, insides);
  }

  /// One entry of the columns.
  struct Entry {
    Ray ray;
    std::uint32_t sample = 0;
    Color throughput{1, 1, 1};
    float distance = 0;
    std::uint8_t bounces = 0;
    bool from_camera = false;
    RayKind kind = RayKind::camera;
    Insides insides{};
  };
  Entry operator[](std::size_t i) const {
    return {rays[i],    sample[i],           throughput[i], distance[i],
            bounces[i], from_camera[i] != 0, kind[i],       insides[i]};
  }
  void push_back(const Entry& e) {
    rays.push_back(e.ray);
    sample.push_back(e.sample), throughput.push_back(e.throughput), distance.push_back(e.distance);
    bounces.push_back(e.bounces), from_camera.push_back(e.from_camera ? 1 : 0);
    kind.push_back(e.kind), insides.push_back(e.insides);
  }
};

/// PathColumns::unsampled of the rest of a ray along which met_lights.h has looked for all lights.
inline constexpr float kAllMet = std::numeric_limits<float>::infinity();

/// What a path knows of the surface that its ray left, beside the columns of a RayQueue: how likely the ray's
/// direction was, and for which point lights would have been chosen there.
struct PathColumns {
  Column<float> pdf;  ///< of the direction, per solid angle; 0 for mirrors and clear glass, which no light
                      ///< sample replaces
  /// Light samples choose no place of an emitter that is nearer than this along the ray: 0, but for rays that
  /// start above the plane of the triangle that they lead behind.
  Column<float> unsampled;
  Column<LightPoint> from;
  /// 1 if any surface on the path sent it on otherwise than mirrors and clear glass do. Set only if
  /// RenderContext::caustics is.
  Column<std::uint8_t> scattered;
  Column<DielectricStack> dielectrics;  ///< the solids around the ray, from the camera on; empty unless the
                                        ///< scene tracks them

  void clear() { resize_uninitialized(0), dielectrics.resize_uninitialized(0); }
  void resize_uninitialized(std::size_t n) {
    pdf.resize_uninitialized(n), unsampled.resize_uninitialized(n);
    from.resize_uninitialized(n), scattered.resize_uninitialized(n);
  }
  void push_back(float density, float unsampled_up_to, const LightPoint& point, bool was_scattered,
                 const DielectricStack* around) {
    pdf.push_back(density), unsampled.push_back(unsampled_up_to);
    from.push_back(point), scattered.push_back(was_scattered ? 1 : 0);
    if (around != nullptr) dielectrics.push_back(*around);
  }
};

/// Working memory for shadow rays that may pass surfaces.
struct PassingRays {
  std::vector<StraightLight> passed;  ///< what has passed, of each ray of the queue
  std::vector<std::uint32_t> left;    ///< rays of the queue that are still followed
  std::vector<std::uint32_t> kept;    ///< entries of `left` that the surface they met may let through
  RayBatch rays, behind;              ///< those of `left`, and their parts behind the surfaces they met
  HitBatch hits;                      ///< of `left`
};

/// Shadow rays. Each adds `light` to the radiance of its owner, an entry of a RayQueue, if nothing blocks it.
struct ShadowQueue {
  RayBatch rays;
  Column<std::uint32_t> owner;
  ColorColumn light;
  Column<std::uint8_t> occluded;        ///< written by find_arriving if nothing lets light pass
  Column<DielectricStack> dielectrics;  ///< the solids at the origins; empty unless the scene tracks them
  PassingRays passing;

  std::size_t size() const { return owner.size(); }

  void clear() { resize_uninitialized(0); }
  void resize_uninitialized(std::size_t n) {
    rays.resize_uninitialized(n), owner.resize_uninitialized(n), light.resize_uninitialized(n);
    if (n == 0) dielectrics.resize_uninitialized(0);
  }
  void set(std::size_t i, const Ray& ray, std::uint32_t ray_owner, const Color& color) {
    rays.set(i, ray), owner[i] = ray_owner, light.set(i, color);
  }
  void push_back(const Ray& ray, std::uint32_t ray_owner, const Color& color) {
    rays.push_back(ray), owner.push_back(ray_owner), light.push_back(color);
  }
};

}  // namespace oktett
