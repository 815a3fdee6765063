#include "accel/isa/exact_code.h"

namespace oktett {

template struct ExactShapeCode<Revolution, OKTETT_ISA>;
template struct ExactShapeCode<Lathe, OKTETT_ISA>;

}  // namespace oktett
