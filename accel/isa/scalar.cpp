#include "accel/isa/instantiate.h"

namespace oktett {

const IsaTable* scalar_table() { return &make_table<ScalarIsa>(); }

}  // namespace oktett
