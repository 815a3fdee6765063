#include "accel/isa/exact_code.h"

namespace oktett {

#if defined(OKTETT_COMPILED_AVX512)
template struct ExactCode<Avx512Isa>;
#endif

}  // namespace oktett
