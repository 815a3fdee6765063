#pragma once
/// \file Which points are inside: by the crossings of one ray from each point, which are counted once.

#include <cstdint>
#include <span>
#include <vector>

#include "accel/point_query.h"

namespace oktett {

/// Answers for one structure. A point is inside of a solid if a ray from it crosses the boundary an odd
/// number of times. Unbounded solids differ: a shape is asked by its function, and a combination whether the
/// far end of the ray is inside of it.
class InsideTest {
 public:
  InsideTest(const Accel& accel, Isa isa);

  /// answers[i] becomes 1 if points[i] is inside of any solid, else 0. Any number of threads may ask.
  void operator()(const PointSpan& points, std::uint8_t* answers) const;

 private:
  /// A solid without bounds.
  struct Unbounded {
    const Accel* accel;
    std::uint32_t geometry, instance, item;
    bool is_combination;
    Affine to_here;  ///< from the space of the structure that is asked
  };

  void find_unbounded(const Accel& accel, const Affine& to_here, std::uint32_t instance);
  /// Whether the ray begins inside of any solid, given all its hits.
  bool is_inside(const Ray& ray, std::span<const Hit> hits) const;

  const Accel& accel_;
  Isa isa_;
  bool is_one_mesh_;
  std::vector<Unbounded> unbounded_;
};

}  // namespace oktett
