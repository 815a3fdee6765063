#pragma once
/// \file Makes the table of functions of one exact surface. Included by the source files that the build makes
/// of kernels/exact_surface.cpp.in.

#include "kernels/exact/exact_interaction.h"
#include "kernels/exact_ops.h"

namespace oktett {

template <class S>
struct ExactOpsCode {
  using Pool = typename S::Pool;
  static const Pool& cast(const ExactPoolBase& pool) { return static_cast<const Pool&>(pool); }

  static std::unique_ptr<ExactPoolBase> make_pool() { return std::make_unique<Pool>(); }
  static void add(ExactPoolBase& pool, const ExactShape& shape, const Affine& to_world, std::uint32_t item) {
    S::add(static_cast<Pool&>(pool), std::get<typename S::Data>(shape.form), {to_world, item, shape.normals});
  }
  static Box bounds(const ExactPoolBase& pool, const ExactCell& cell) {
    if constexpr (requires { S::world_bounds(cast(pool), cell.element); })
      return S::world_bounds(cast(pool), cell.element);
    else
      return cell_bounds(pool.frames[cell.element], cell);
  }
  static bool inside(const ExactPoolBase& pool, std::size_t element, const Vec3d& p) {
    return is_inside<S>(cast(pool), element, p);
  }
  template <bool kWithUv>
  static void interaction(const ExactPoolBase& pool, std::size_t element, const Ray& ray, const Hit& hit,
                          SurfaceInteraction& s) {
    if constexpr (requires { S::interaction(cast(pool), element, ray, hit); })
      s = S::interaction(cast(pool), element, ray, hit);
    else
      s = exact_interaction<S, kWithUv>(cast(pool), element, ray, hit);
  }
  static Vec2f uv(const ExactPoolBase& pool, std::size_t element, int part, const Vec3d& own) {
    return rounded(S::uv(cast(pool), element, part, own));
  }
  static std::size_t bytes(const ExactPoolBase& pool) { return cast(pool).bytes(); }
  static SurfaceNearest closest(const ExactPoolBase& pool, std::size_t element, const Affine& to_world,
                                const Vec3d& p) {
    return S::closest(cast(pool), element, to_world, p);
  }
};

template <class S>
constexpr ExactOps make_exact_ops(const char* name) {
  using Code = ExactOpsCode<S>;
  constexpr bool one_cell = requires { S::kOneCell; };
  constexpr bool sheets = requires { S::kSheets; };
  ExactOps ops{name,
               S::kMaxCrossings,
               one_cell,
               sheets,
               Code::make_pool,
               Code::add,
               Code::bounds,
               Code::inside,
               Code::template interaction<true>,
               Code::template interaction<false>,
               nullptr,
               Code::bytes,
               nullptr,
               nullptr};
  if constexpr (requires(const typename Code::Pool& pool) { S::uv(pool, 0, 0, Vec3d{}); }) ops.uv = Code::uv;
  if constexpr (requires { &S::closest; }) ops.closest = Code::closest, ops.is_kept_by = S::is_kept_by;
  return ops;
}

}  // namespace oktett
