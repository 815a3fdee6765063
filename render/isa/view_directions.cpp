#include "render/isa/view_directions.h"

namespace oktett {

template const ViewCode& view_code<OKTETT_ISA>();

}  // namespace oktett
