#include "accel/isa/exact_code.h"

namespace oktett {

#if defined(OKTETT_COMPILED_AVX2)
template struct ExactCode<Avx2Isa>;
#endif

}  // namespace oktett
