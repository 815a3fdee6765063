#include "verify/isa/kernel_probe.h"

namespace oktett {

template const KernelProbeCode& kernel_probe_code<OKTETT_ISA>();

}  // namespace oktett
