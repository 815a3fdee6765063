#include "accel/isa/exact_code.h"

namespace oktett {

#if defined(OKTETT_COMPILED_SSE42)
template struct ExactCode<Sse42Isa>;
#endif

}  // namespace oktett
