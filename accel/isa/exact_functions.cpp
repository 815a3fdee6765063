#include "accel/isa/exact_code.h"

namespace oktett {

template struct ExactShapeCode<Implicit, OKTETT_ISA>;

}  // namespace oktett
