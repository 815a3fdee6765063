#include "accel/build/kernels.h"

namespace oktett {

template const BuildKernels& build_kernels<OKTETT_ISA>();

}  // namespace oktett
