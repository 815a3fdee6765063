#include "accel/exact.h"

#include "accel/isa/exact_shape.h"
#include "kernels/exact_shapes.h"

namespace oktett {

/// ExactShapeCode::first for the only ray in `lanes`, by the scalar code, whose bits are the same.
template <class S, class F>
unsigned first_of_one(const typename S::Pool& pool, std::uint32_t cell, const RayLanes<F>& rays,
                      unsigned lanes, HitLanes<F>& hits) {
  using One = Simd<float, 1, ScalarIsa>;
  const int k = __builtin_ctz(lanes);
  const auto lone = [&](const F& x) {
    float column[F::kWidth];
    x.store(column);
    return One(column[k]);
  };
  const RayLanes<One> ray{{lone(rays.o.x), lone(rays.o.y), lone(rays.o.z)},
                          {lone(rays.d.x), lone(rays.d.y), lone(rays.d.z)},
                          lone(rays.tmin),
                          lone(rays.tmax)};
  HitLanes<One> hit;
  const unsigned met = ExactShapeCode<S, ScalarIsa>::first(pool, cell, ray, 1, hit);
  hits.t = F(hit.t.part[0].v), hits.u = F(hit.u.part[0].v), hits.v = F(hit.v.part[0].v);
  return met << k;
}

template <class A>
unsigned ExactCode<A>::first(const Accel& accel, Kind kind, std::uint32_t cell, const RayLanes<F>& rays,
                             unsigned lanes, HitLanes<F>& hits, std::uint32_t& item) {
  unsigned met = 0;
  visit_exact(kind, *accel.exact, [&](auto shape, const auto& pool) {
    using S = decltype(shape);
    item = pool.frames[pool.cells[cell].element].item;
    if constexpr (requires { S::kLoneLanes; } && F::kWidth > 1)
      if ((lanes & (lanes - 1)) == 0) return void(met = first_of_one<S>(pool, cell, rays, lanes, hits));
    met = ExactShapeCode<S, A>::first(pool, cell, rays, lanes, hits);
  });
  return met;
}

template <class A>
void ExactCode<A>::all(const Accel& accel, Kind kind, std::uint32_t cell, const Ray& ray,
                       HitList& hits) requires std::is_same_v<A, ScalarIsa> {
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
