#include "verify/isa/roots_probe.h"

namespace oktett {

template void run_roots<OKTETT_ISA>(RootsKernel, const RootsProbe&);

}  // namespace oktett
