#include "accel/exact_table.h"

namespace oktett {

template <class A>
constexpr ExactTable<A> make_exact_table() {
  ExactTable<A> table{};
#define SURFACE(Type, name)                                                       \
  table.of[static_cast<int>(Kind::name)] = {                                      \
      ExactSurfaceCode<Type, A>::first,   ExactSurfaceCode<Type, ScalarIsa>::all, \
      ExactSurfaceCode<Type, A>::rows,    ExactSurfaceCode<Type, A>::filter,      \
      ExactSurfaceCode<Type, A>::outside, ExactSurfaceCode<Type, A>::interactions};
#include "kernels/exact/surfaces.def"
#undef SURFACE
  return table;
}

template <class A>
constexpr ExactTable<A> ExactTable<A>::table = make_exact_table<A>();

template struct ExactTable<OKTETT_ISA>;

}  // namespace oktett
