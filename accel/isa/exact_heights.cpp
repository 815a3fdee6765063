#include "accel/isa/exact_code.h"
#include "kernels/heights/height_crossings.h"

namespace oktett {

template struct ExactShapeCode<HeightField, OKTETT_ISA>;

}  // namespace oktett
