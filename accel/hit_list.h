#pragma once
/// \file A growing list of hits for code that is compiled per instruction set: it calls out to grow, so that
/// no template of the standard library is instantiated there with instructions that the baseline lacks.

#include <cstddef>
#include <vector>

#include "core/ray.h"

namespace oktett {

class Accel;

/// Whether an item of the structure, not of one inside, is a triangle of a mesh.
bool is_triangle(const Accel& accel, std::uint32_t item);

class HitList {
 public:
  explicit HitList(std::vector<Hit>& hits) : hits_(hits) {}
  void push(const Hit& hit);
  std::size_t size() const;
  Hit& operator[](std::size_t i);
  void shrink(std::size_t size);

 private:
  std::vector<Hit>& hits_;
};

/// Of the hits from `first` on with exact surfaces that are not inside an instance, makes one list per item:
/// sorted, in and out in turn. Cells of an element may each list a crossing where they meet; what overlaps is
/// taken together.
void merge_crossings(const Accel& accel, HitList& hits, std::size_t first);

}  // namespace oktett
