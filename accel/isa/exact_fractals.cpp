#include "accel/isa/exact_code.h"

namespace oktett {

template struct ExactShapeCode<Sphereflake, OKTETT_ISA>;
template struct ExactShapeCode<Menger, OKTETT_ISA>;
template struct ExactShapeCode<Ifs, OKTETT_ISA>;
template struct ExactShapeCode<Julia, OKTETT_ISA>;
template struct ExactShapeCode<Terrain, OKTETT_ISA>;

}  // namespace oktett
