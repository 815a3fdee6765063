#pragma once
/// \file The kinds: everything that a leaf of the tree can hold. What a kind can do is looked up by name
/// here, in the table of an exact surface (kernels/exact_ops.h) or of the kernel of a closed form
/// (kernels/closed_forms.h); nothing follows from the order of the enumeration.

#include <cstdint>

#include "core/platform.h"
#include "kernels/closed/shape_data.h"

namespace oktett {

enum class Kind : std::uint8_t {
// Closed forms.
#define FORM(Kernel, Data, name) name,
  OKTETT_CLOSED_FORMS(FORM)
#undef FORM
// Exact surfaces.
#define SURFACE(Type, name) name,
#include "kernels/exact/surfaces.def"
#undef SURFACE
      triangle,
  csg,
  instance,
  instance_list
};
inline constexpr int kKinds = static_cast<int>(Kind::instance_list) + 1;

OKTETT_INLINE constexpr bool is_closed_form(Kind kind) {
  switch (kind) {
#define FORM(Kernel, Data, name) case Kind::name:
    OKTETT_CLOSED_FORMS(FORM)
#undef FORM
    return true;
    default:
      return false;
  }
}
OKTETT_INLINE constexpr bool is_exact(Kind kind) {
  switch (kind) {
#define SURFACE(Type, name) case Kind::name:
#include "kernels/exact/surfaces.def"
#undef SURFACE
    return true;
    default:
      return false;
  }
}
/// The name of a mathematical shape, as in the list of its sort.
constexpr const char* name_of(Kind kind) {
  switch (kind) {
#define FORM(Kernel, Data, name) \
  case Kind::name:               \
    return #name;
    OKTETT_CLOSED_FORMS(FORM)
#undef FORM
#define SURFACE(Type, name) \
  case Kind::name:          \
    return #name;
#include "kernels/exact/surfaces.def"
#undef SURFACE
    default:
      return "";
  }
}
/// One mathematical shape, of either sort.
OKTETT_INLINE constexpr bool is_shape(Kind kind) { return is_closed_form(kind) || is_exact(kind); }
OKTETT_INLINE constexpr bool holds_instances(Kind kind) {
  return kind == Kind::instance || kind == Kind::instance_list;
}
/// Kinds whose items cost more to test than a node of the tree.
OKTETT_INLINE constexpr bool stands_alone(Kind kind) {
  return is_exact(kind) || kind == Kind::csg || holds_instances(kind);
}

}  // namespace oktett
