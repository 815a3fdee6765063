#include "verify/isa/roots_probe.h"

namespace oktett {

template const RootsProbeCode& roots_probe_code<OKTETT_ISA>();

}  // namespace oktett
