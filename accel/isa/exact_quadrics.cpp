#include "accel/isa/exact_code.h"

namespace oktett {

template struct ExactShapeCode<Torus, OKTETT_ISA>;
template struct ExactShapeCode<Cylinder, OKTETT_ISA>;
template struct ExactShapeCode<Cone, OKTETT_ISA>;
template struct ExactShapeCode<Polyhedron, OKTETT_ISA>;
template struct ExactShapeCode<Quadric, OKTETT_ISA>;

}  // namespace oktett
