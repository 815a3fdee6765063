#include "accel/isa/exact_code.h"

namespace oktett {

template struct ExactShapeCode<Superquadric, OKTETT_ISA>;

}  // namespace oktett
