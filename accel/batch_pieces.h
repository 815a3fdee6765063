#pragma once
/// \file What the queries over batches have in common: checks, columns, and pieces that threads share out.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <span>
#include <string>

#include "core/error.h"
#include "core/ray.h"

namespace oktett {

/// Larger batches are traced in pieces of this size, each a task.
inline constexpr std::size_t kPieceRays = 4096;

/// Calls trace(begin, count) for each piece of a batch.
template <class Trace>
void for_each_piece(std::size_t size, Trace&& trace) {
  if (size <= kPieceRays) return trace(std::size_t{0}, size);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, (size + kPieceRays - 1) / kPieceRays),
                    [&](const auto& r) {
                      for (std::size_t k = r.begin(); k < r.end(); ++k)
                        trace(k * kPieceRays, std::min(kPieceRays, size - k * kPieceRays));
                    });
}

inline void require_same_size(std::size_t rays, std::size_t answers, const char* query) {
  if (rays != answers)
    throw Error(std::string(query) + ": " + std::to_string(rays) + " rays, but room for " +
                std::to_string(answers) + " answers");
}

/// The rays as columns.
inline RaySpan to_columns(std::span<const Ray> rays, RayBatch& columns) {
  columns.resize_uninitialized(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) columns.set(i, rays[i]);
  return columns.span();
}

}  // namespace oktett
