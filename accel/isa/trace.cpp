#include "accel/isa/instantiate.h"

namespace oktett {

template const IsaTable& isa_code<OKTETT_ISA>();

}  // namespace oktett
