#include "accel/exact_table.h"
#include "accel/isa/mesh_interactions.h"
#include "accel/isa/shape_interactions.h"
#include "accel/surface/interaction_code.h"

namespace oktett {

template <class A>
bool exact_interactions_code(Kind kind, const ExactPoolBase& pool, ShapeHits& hits) {
  return exact_code<A>(kind).interactions(pool, hits);
}

template <class A>
std::uint64_t name_hits_code(const std::uint32_t* items, std::size_t count, const GeometryItems& geometry,
                             InteractionBlock& out) {
  using I = Simd<std::int32_t, kItemGroup, A>;
  const auto same = [](std::uint32_t x) { return I(static_cast<std::int32_t>(x)); };
  // Lanes compare signed numbers. With the lowest number added, these have the order of unsigned ones.
  const I lowest(INT32_MIN), first = same(geometry.first), end = same(geometry.count) + lowest;
  const I number = same(geometry.geometry), user = same(geometry.user), slot(0);
  std::uint64_t found = 0;
  for (std::size_t i = 0; i < count; i += kItemGroup) {
    const I primitive = I::load(reinterpret_cast<const std::int32_t*>(items) + i) - first;
    const auto here = primitive + lowest < end;
    const auto set = [&](const I& value, std::uint32_t* column) {
      auto* to = reinterpret_cast<std::int32_t*>(column + i);
      select(here, value, I::load(to)).store(to);
    };
    set(number, out.geometry), set(primitive, out.primitive), set(user, out.user),
        set(slot, out.material_slot);
    found |= std::uint64_t{bits(here)} << i;
  }
  return found;
}

template <class A>
const InteractionCode& interaction_code() {
  static constexpr InteractionCode code = {name_hits_code<A>, mesh_surfaces_code<A>, closed_surfaces_code<A>,
                                           exact_interactions_code<A>};
  return code;
}

template const InteractionCode& interaction_code<OKTETT_ISA>();

}  // namespace oktett
