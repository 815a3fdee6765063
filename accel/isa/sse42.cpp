#include "accel/isa/instantiate.h"

namespace oktett {

const IsaTable* sse42_table() {
#if defined(OKTETT_COMPILED_SSE42)
  return &make_table<Sse42Isa>();
#else
  return nullptr;
#endif
}

}  // namespace oktett
