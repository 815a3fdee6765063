#pragma once
/// \file A list of crossings for code that is compiled per instruction set. Its functions are compiled for
/// the baseline, so that no template of the standard library is instantiated with instructions that the
/// baseline lacks.

#include <cstddef>
#include <vector>

#include "core/ray.h"

namespace oktett {

class Accel;

/// Whether an item of the structure itself is a triangle of a mesh.
bool is_triangle(const Accel& accel, std::uint32_t item);

/// Whether the transform of a mesh mirrors it, which reverses the winding of its triangles.
bool is_mirrored(const Accel& accel, std::uint32_t item);

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

}  // namespace oktett
