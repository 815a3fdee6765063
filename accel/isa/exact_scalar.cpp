#include "accel/isa/exact_code.h"

namespace oktett {

template struct ExactCode<ScalarIsa>;

}  // namespace oktett
