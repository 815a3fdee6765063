#include "accel/exact.h"

#include "accel/isa/exact_shape.h"
#include "kernels/exact_shapes.h"

namespace oktett {

template <class A>
unsigned ExactCode<A>::first(const Accel& accel, Kind kind, std::uint32_t cell, const RayLanes<F>& rays,
                             unsigned lanes, HitLanes<F>& hits, std::uint32_t& item) {
  unsigned met = 0;
  visit_exact(kind, *accel.exact, [&](auto shape, const auto& pool) {
    item = pool.frames[pool.cells[cell].element].item;
    met = ExactShapeCode<decltype(shape), A>::first(pool, cell, rays, lanes, hits);
  });
  return met;
}

template <class A>
void ExactCode<A>::all(const Accel& accel, Kind kind, std::uint32_t cell, const Ray& ray, HitList& hits) {
  visit_exact(kind, *accel.exact, [&](auto shape, const auto& pool) {
    ExactShapeCode<decltype(shape), A>::all(pool, cell, ray, hits);
  });
}

template <class A>
std::uint32_t ExactCode<A>::rows(const Accel& accel, Kind kind, std::uint32_t cell, const RayLanes<F>& rays,
                                 unsigned lanes, CrossingLanes<kLanes>& out) {
  std::uint32_t item = kNoId;
  visit_exact(kind, *accel.exact, [&](auto shape, const auto& pool) {
    if (!has_one_cell(kind)) return;
    item = pool.frames[pool.cells[cell].element].item;
    ExactShapeCode<decltype(shape), A>::rows(pool, cell, rays, lanes, out);
  });
  return item;
}

template <class A>
bool ExactCode<A>::surfaces(const Accel& accel, Kind kind, ShapeHits& hits) {
  bool done = false;
  visit_exact(kind, *accel.exact, [&](auto shape, const auto& pool) {
    done = pool.frames[hits.element[0]].normals == NormalMethod::gradient &&
           ExactShapeCode<decltype(shape), A>::surfaces(pool, hits);
  });
  return done;
}

template struct ExactCode<OKTETT_ISA>;

}  // namespace oktett
