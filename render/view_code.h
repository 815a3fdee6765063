#pragma once
/// \file Camera directions, as they are compiled for each instruction set in render/isa.

#include "core/isa_select.h"
#include "render/view_directions.h"

namespace oktett {

struct ViewCode {
  void (*directions)(const ViewPlane&, const ViewPoints&);
};

template <class A>
const ViewCode& view_code();

inline const ViewCode& view_code(Isa isa) {
  return with_isa(isa, []<class A>() -> const ViewCode& { return view_code<A>(); });
}

}  // namespace oktett
