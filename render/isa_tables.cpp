/// \file The table of this layer's code by instruction set.

#include "core/isa_select.h"
#include "render/transport/render_code.h"

namespace oktett {

const RenderCode& render_code(Isa isa) {
  return with_isa(isa, []<class A>() -> const RenderCode& { return render_code<A>(); });
}

}  // namespace oktett
