#include "kernels/roots/bernstein_lanes.h"
#include "kernels/roots/closed_form.h"
#include "verify/isa/load_column.h"
#include "verify/probes/kernel_probe.h"

namespace oktett {

// ---- Root finders over columns of polynomials, for one instruction set.

template <int N, class D>
void run_closed(const RootsProbe& run) {
  constexpr int W = D::kWidth;
  for (std::size_t at = 0; at < run.count; at += W) {
    D c[N + 1], x[N];
    for (int i = 0; i <= N; ++i) c[i] = load_column<D>(run.c[i], at, run.count);
    if constexpr (N == 2) roots::solve_quadratic(c, x);
    if constexpr (N == 3) roots::solve_cubic(c, x);
    if constexpr (N == 4) roots::solve_quartic(c, x);
    for (int k = 0; k < N; ++k) {
      double lanes[W];
      x[k].store(lanes);
      for (int i = 0; i < W && at + i < run.count; ++i) run.x[k][at + i] = lanes[i];
    }
  }
}

template <int N, int K, class D>
void run_certified(const RootsProbe& run) {
  constexpr int W = D::kWidth;
  for (std::size_t at = 0; at < run.count; at += W) {
    D c[N + 1];
    for (int i = 0; i <= N; ++i) c[i] = load_column<D>(run.c[i], at, run.count);
    const auto active = D::M::from_bits(run.count - at < W ? (1u << (run.count - at)) - 1 : (1u << W) - 1);
    const auto answer = roots::certified_roots<N, K>(c, load_column<D>(run.a, at, run.count),
                                                     load_column<D>(run.b, at, run.count), active);
    for (int k = 0; k < K; ++k) {
      double x[W], error[W];
      answer.x[k].store(x);
      answer.error[k].store(error);
      for (int i = 0; i < W && at + i < run.count; ++i)
        run.x[k][at + i] = x[i], run.error[k][at + i] = error[i];
    }
    for (int i = 0; i < W && at + i < run.count; ++i) run.unsure[at + i] = bits(answer.unsure) >> i & 1;
  }
}

template <class A>
void run_roots(RootsKernel id, const RootsProbe& run) {
  using D = Simd<double, std::is_same_v<A, ScalarIsa> ? 1 : 8, A>;
  // In the order of RootsKernel.
  static constexpr void (*kKernels[])(const RootsProbe&) = {
      run_closed<2, D>,       run_closed<3, D>,       run_closed<4, D>,       run_certified<2, 2, D>,
      run_certified<3, 3, D>, run_certified<4, 4, D>, run_certified<6, 6, D>, run_certified<4, 1, D>};
  kKernels[static_cast<int>(id)](run);
}

template void run_roots<OKTETT_ISA>(RootsKernel, const RootsProbe&);

}  // namespace oktett
