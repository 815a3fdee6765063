/// \file The tables of this layer's code by instruction set.

#include "core/isa_select.h"
#include "verify/probes/kernel_probe.h"
#include "verify/probes/simd_probe.h"

namespace oktett {

static const KernelProbeCode& kernel_probe_code(Isa isa) {
  return with_isa(isa, []<class A>() -> const KernelProbeCode& { return kernel_probe_code<A>(); });
}

std::span<const int> probe_widths(Isa isa) { return kernel_probe_code(isa).widths; }

void probe_kernel(Isa isa, KernelId id, int width, const KernelProbe& probe) {
  kernel_probe_code(isa).run(id, width, probe);
}

const SimdProbeCode& simd_probe_code(Isa isa) {
  return with_isa(isa, []<class A>() -> const SimdProbeCode& { return simd_probe_code<A>(); });
}

void probe_roots(Isa isa, RootsKernel id, const RootsProbe& probe) {
  with_isa(isa, [&]<class A>() { run_roots<A>(id, probe); });
}

}  // namespace oktett
