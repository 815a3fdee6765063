#include "accel/isa/exact_code.h"

namespace oktett {

template struct ExactShapeCode<Metaballs, OKTETT_ISA>;
template struct ExactShapeCode<BlobTree, OKTETT_ISA>;

}  // namespace oktett
