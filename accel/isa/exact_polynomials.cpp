#include "accel/isa/exact_code.h"

namespace oktett {

template struct ExactShapeCode<PolynomialSurface, OKTETT_ISA>;
template struct ExactShapeCode<Blob, OKTETT_ISA>;

}  // namespace oktett
