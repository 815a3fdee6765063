#pragma once
/// \file A growing list of crossings for code that is compiled per instruction set: it calls out to grow, so
/// that no template of the standard library is instantiated there with instructions that the baseline lacks.

#include <cstddef>
#include <vector>

#include "core/ray.h"

namespace oktett {

class Accel;

/// Whether an item of the structure, not of one inside, is a triangle of a mesh.
bool is_triangle(const Accel& accel, std::uint32_t item);

/// Whether a mirroring transform has turned the winding of a triangle round.
bool is_mirrored(const Accel& accel, std::uint32_t item);

/// A hit, and whether the ray enters (-1) or leaves (1) a solid there; 0 for what is no solid.
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

 private:
  std::vector<Crossing>& hits_;
};

/// Of the hits from `first` on with exact surfaces that are not inside an instance, makes one list per item:
/// sorted, in and out in turn. Cells of an element may each list a crossing where they meet; what overlaps is
/// taken together.
void merge_crossings(const Accel& accel, HitList& hits, std::size_t first);

}  // namespace oktett
