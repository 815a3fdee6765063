#pragma once
/// \file Queries on the arrays of Python: points in rows, answers in columns. Each function works on one
/// thread.

#include <cstddef>
#include <cstdint>

#include "accel/point_query.h"
#include "python/src/ray_queries.h"
#include "render/geometry.h"

namespace oktett::python {

/// Where nearest points go. A column that is null is not wanted.
struct ClosestColumns {
  float* distance = nullptr;
  PlaceColumn point;
  HitColumns hit;  ///< what was found there; `t` and `position` are not wanted
};

/// The nearest points of all surfaces for points [begin, end), each three floats. A miss has the distance
/// infinite, all ids kNoId and all else 0.
void closest_points(const World& world, const float* points, std::size_t begin, std::size_t end,
                    const ClosestColumns& out);

/// answers[i] becomes 1 or 0 for the points [begin, end).
void inside(const World& world, const float* points, std::size_t begin, std::size_t end, InsideRule rule,
            std::uint8_t* answers);

/// numbers[i] becomes the winding number at the point, off by at most `error`.
void winding_numbers(const World& world, const float* points, std::size_t begin, std::size_t end,
                     double error, float* numbers);

/// distances[i] becomes the distance to the nearest surface, negative inside of solids.
void signed_distances(const World& world, const float* points, std::size_t begin, std::size_t end,
                      InsideRule rule, float* distances);

}  // namespace oktett::python
