#include "kernels/exact_ops.h"

#include <atomic>
#include <cmath>
#include <cstdlib>

#include "kernels/exact/march.h"
#include "kernels/exact_form.h"

namespace oktett {

// Each is defined in a source file that the build makes of kernels/exact_surface.cpp.in.
#define SURFACE(Type, name) extern const ExactOps name##_ops;
#include "kernels/exact/surfaces.def"
#undef SURFACE

// What no unit of a wider instruction set may define.
ExactPoolBase::~ExactPoolBase() = default;

static std::atomic<std::uint64_t> uncertified{0};
void interval::count_uncertified(int rays) { uncertified += static_cast<std::uint64_t>(rays); }
std::uint64_t interval::uncertified_count() { return uncertified; }

const ExactOps& exact_ops(Kind kind) {
  switch (kind) {
#define SURFACE(Type, name) \
  case Kind::name:          \
    return name##_ops;
#include "kernels/exact/surfaces.def"
#undef SURFACE
    default:
      std::abort();
  }
}

Kind kind_of(const ExactForm& form) {
  static constexpr Kind kinds[] = {
#define SURFACE(Type, name) Kind::name,
#include "kernels/exact/surfaces.def"
#undef SURFACE
  };
  return kinds[form.index()];
}

Box cell_bounds(const ExactFrame& frame, const ExactCell& cell) {
  Box b;
  for (int k = 0; k < 3; ++k)
    if (!std::isfinite(cell.lo[k]) || !std::isfinite(cell.hi[k])) return b;
  const Affine& to_world = frame.to_world;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3d p;
    for (int k = 0; k < 3; ++k) p[k] = (corner >> k & 1) != 0 ? cell.hi[k] : cell.lo[k];
    const Vec3d q = to_world.point(p);
    // What may be displaced when a ray is taken into the own space.
    const double coordinates = 0x1p-45 * (length(q) + length(to_world.vector(p)));
    const Vec3d pad =
        displacement(frame.to_own, to_world, abs(q)) + Vec3d{coordinates, coordinates, coordinates};
    b.grow(Box{round_down(q - pad), round_up(q + pad)});
  }
  return b;
}

/// Calls f(bounds) for each cell of `shape`; empty bounds are those of a cell that is not bounded.
template <class Function>
static void each_cell_bounds(const ExactShape& shape, const Affine& to_world, Function&& f) {
  const ExactOps& ops = exact_ops(kind_of(shape.form));
  const auto pool = ops.make_pool();
  ops.add(*pool, shape, to_world, 0);
  for (const ExactCell& cell : pool->cells) f(ops.cell_bounds(*pool, cell));
}

Box exact_bounds(const ExactShape& shape, const Affine& to_world) {
  Box bounds;
  bool bounded = true;
  each_cell_bounds(shape, to_world, [&](const Box& b) {
    bounded &= !b.empty();
    bounds.grow(b);
  });
  return bounded ? bounds : Box{};
}

bool is_unbounded(const ExactShape& shape, const Affine& to_world) {
  bool unbounded = false;
  each_cell_bounds(shape, to_world, [&](const Box& b) { unbounded |= b.empty(); });
  return unbounded;
}

// ---- The data of exact surfaces.

ExactForm::ExactForm() = default;
ExactForm::ExactForm(const ExactForm&) = default;
ExactForm::ExactForm(ExactForm&&) noexcept = default;
ExactForm& ExactForm::operator=(const ExactForm&) = default;
ExactForm& ExactForm::operator=(ExactForm&&) noexcept = default;
ExactForm::~ExactForm() = default;

bool is_open(const ExactShape& shape) {
  return std::visit(
      [](const auto& form) {
        // Without a box a quadric or a blob has no faces that could be missing.
        if constexpr (requires { form.clipped; })
          return form.open && form.clipped;
        else if constexpr (requires { form.bounded; })
          return form.open && form.bounded;
        else if constexpr (requires { form.open; })
          return form.open;
        else
          return false;
      },
      shape.form);
}

}  // namespace oktett
