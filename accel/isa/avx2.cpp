#include "accel/isa/instantiate.h"

namespace oktett {

const IsaTable* avx2_table() {
#if defined(OKTETT_COMPILED_AVX2)
  return &make_table<Avx2Isa>();
#else
  return nullptr;
#endif
}

}  // namespace oktett
