#include "accel/isa/exact_code.h"

namespace oktett {

template struct ExactShapeCode<Sphereflake, OKTETT_ISA>;
template struct ExactShapeCode<Menger, OKTETT_ISA>;

}  // namespace oktett
