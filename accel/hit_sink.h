#pragma once
/// \file What a traversal looks for, and where its results go.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/platform.h"
#include "core/ray.h"

namespace oktett {

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
