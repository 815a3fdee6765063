#include "accel/isa/instantiate.h"

namespace oktett {

const IsaTable* avx512_table() {
#if defined(OKTETT_COMPILED_AVX512)
  return &make_table<Avx512Isa>();
#else
  return nullptr;
#endif
}

}  // namespace oktett
