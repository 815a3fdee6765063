#pragma once
/// \file What a traversal looks for, and where its results go: a sink for one hit a ray, lists for all.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/platform.h"
#include "core/ray.h"

namespace oktett {

// ---- A list of crossings for code that is compiled per instruction set. Its functions are compiled for the
// baseline, so that no template of the standard library is instantiated with instructions that the baseline
// lacks.

class Accel;

/// Whether an item of the structure itself is a triangle of a mesh.
bool is_triangle(const Accel& accel, std::uint32_t item);

/// Whether the transform of a mesh mirrors it, which reverses the winding of its triangles.
bool is_mirrored(const Accel& accel, std::uint32_t item);

/// The order in which hits are listed and count: by t, then by (instance, item).
bool listed_before(const Hit& a, const Hit& b);

/// A hit, and its turn: -1 if the ray enters a solid there, 1 if it leaves it; 0 for shapes without an
/// inside.
struct Crossing {
  Hit hit;
  float turn = 0;
};

class HitList {
 public:
  explicit HitList(std::vector<Crossing>& hits) : hits_(hits) {}
  void push(const Hit& hit, float turn);
  std::size_t size() const;
  Crossing& operator[](std::size_t i);
  void shrink(std::size_t size);
  std::vector<Crossing>& crossings() { return hits_; }
  /// Whether crossings with what only cuts a combination are listed, as is needed to tell where a ray is
  /// inside of it.
  bool keeps_unseen = false;

 private:
  std::vector<Crossing>& hits_;
};

/// A crossing of ray number `ray` of a batch.
struct RayHit {
  Crossing crossing;
  std::uint32_t ray = 0;
};

/// The crossings of a batch of rays, in no order.
class RayHitList {
 public:
  void append(const RayHit* hits, int count);
  void clear() { hits_.clear(); }
  const std::vector<RayHit>& hits() const { return hits_; }
  /// A list for one ray, empty.
  HitList& scratch() { return scratch_; }
  /// Moves the crossings in scratch() here, as those of ray number `ray`.
  void take_scratch(std::size_t ray);

 private:
  std::vector<RayHit> hits_;
  std::vector<Crossing> scratch_hits_;
  HitList scratch_{scratch_hits_};
};

/// Merges the crossings of exact surfaces among the hits from `first` on. The cells of a surface may each
/// list a crossing where they meet; afterwards the crossings of an item are sorted and alternate between in
/// and out. Hits inside instances are left alone.
void merge_crossings(const Accel& accel, HitList& hits, std::size_t first);

// ---- What a traversal looks for, and where its results go.

/// The nearest hit of each ray, or only whether there is one.
enum class Query { closest, any };

/// The results of a batch of rays: hits for Query::closest, a byte per ray for Query::any, 1 if it hits
/// anything.
template <Query Q>
struct HitSink;

template <>
struct HitSink<Query::closest> {
  HitSpan hits;

  void set(std::size_t i, const Hit& h) const { hits.set(i, h); }
  /// No hits for `count` rays from `begin` on.
  void clear(std::size_t begin, std::size_t count) const {
    const Hit none;
    std::fill_n(hits.t + begin, count, none.t);
    std::fill_n(hits.u + begin, count, none.u), std::fill_n(hits.v + begin, count, none.v);
    std::fill_n(hits.item + begin, count, none.item);
    std::fill_n(hits.instance + begin, count, none.instance);
  }
  /// Prefetches the lines that hold the results of ray i and of its neighbours, to be written.
  /// Inlined by force, because GCC removes calls of functions that only prefetch.
  OKTETT_INLINE void prefetch(std::size_t i) const {
    __builtin_prefetch(hits.t + i, 1), __builtin_prefetch(hits.u + i, 1), __builtin_prefetch(hits.v + i, 1);
    __builtin_prefetch(hits.item + i, 1), __builtin_prefetch(hits.instance + i, 1);
  }
  HitSink part(std::size_t begin, std::size_t count) const { return {hits.part(begin, count)}; }
};

template <>
struct HitSink<Query::any> {
  std::uint8_t* occluded;

  void set(std::size_t i, const Hit& h) const { occluded[i] = h.valid(); }
  void clear(std::size_t begin, std::size_t count) const {
    std::fill_n(occluded + begin, count, std::uint8_t{0});
  }
  void prefetch(std::size_t) const {}  ///< not needed: one line holds the results of 64 rays
  HitSink part(std::size_t begin, std::size_t) const { return {occluded + begin}; }
};

}  // namespace oktett
