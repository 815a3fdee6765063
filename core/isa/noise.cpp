#include "core/noise_code.h"

namespace oktett {

template void noise_code<OKTETT_ISA>(const Vec3d* places, std::size_t count, double* values);

}  // namespace oktett
