#pragma once
/// \file What the queries over batches have in common: checks, and pieces of a batch, which are traced in
/// parallel.

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <span>
#include <string>

#include "core/error.h"
#include "core/ray.h"

namespace oktett {

/// Larger batches are traced in pieces of this size, each a task.
inline constexpr std::size_t kPieceRays = 4096;

/// Calls work(k) for k from 0 to `count` - 1, in parallel. A thread that waits for the others takes no other
/// task meanwhile: it would run in the middle of the task that asked, with the thread's own data half
/// changed.
template <class Work>
void for_each_task(std::size_t count, Work&& work) {
  tbb::this_task_arena::isolate([&] { tbb::parallel_for(std::size_t{0}, count, work); });
}

inline std::size_t piece_count(std::size_t size) { return (size + kPieceRays - 1) / kPieceRays; }

inline std::size_t ray_count(const RaySpan& rays) { return rays.size; }
inline std::size_t ray_count(std::span<const Ray> rays) { return rays.size(); }

/// Rays `begin` to `begin + count - 1` of a batch, in columns.
inline RaySpan piece_columns(const RaySpan& rays, std::size_t begin, std::size_t count) {
  return rays.part(begin, count);
}

/// The same for an array of rays. The columns are valid until the thread's next call.
inline RaySpan piece_columns(std::span<const Ray> rays, std::size_t begin, std::size_t count) {
  static thread_local RayBatch columns;
  columns.resize_uninitialized(count);
  for (std::size_t i = 0; i < count; ++i) columns.set(i, rays[begin + i]);
  return columns.span();
}

/// Calls trace(begin, piece) for each piece of a batch: the rays from number `begin` on, as a RaySpan. `Rays`
/// is RaySpan or std::span<const Ray>.
template <class Rays, class Trace>
void for_each_piece(const Rays& rays, Trace&& trace) {
  const std::size_t size = ray_count(rays);
  const auto trace_from = [&](std::size_t begin) {
    trace(begin, piece_columns(rays, begin, std::min(kPieceRays, size - begin)));
  };
  if (size <= kPieceRays) return trace_from(0);
  for_each_task(piece_count(size), [&](std::size_t k) { trace_from(k * kPieceRays); });
}

inline void require_same_size(std::size_t size, std::size_t answers, const char* query,
                              const char* what = "rays") {
  if (size != answers)
    throw Error(std::string(query) + ": " + std::to_string(size) + " " + what + ", but room for " +
                std::to_string(answers) + " answers");
}

}  // namespace oktett
