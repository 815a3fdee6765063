#pragma once
/// \file Single kernels and root finders by themselves, for verification and benchmarks.

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/isa.h"
#include "core/ray.h"

namespace oktett {

// ---- Kernels.

/// A kernel to be run by itself on `count` pairs of a ray and a shape, for verification and benchmarks. All
/// columns hold `count` elements; hit[i] becomes 1 or 0, and t, u, v are defined where it is 1.
struct KernelProbe {
  std::size_t count = 0;
  RaySpan rays;
  const float* corner[3][3] = {};  ///< triangles: [corner][axis]
  const double* shape[12] = {};    ///< other shapes: the numbers of their Lanes
  float* t = nullptr;
  float* u = nullptr;
  float* v = nullptr;
  std::uint8_t* hit = nullptr;
};

/// The kernels that can be run by themselves.
enum class KernelId : std::uint8_t {
  triangle_watertight,
  triangle_moller_trumbore,
  triangle_badouel,
  triangle_segura_feito,
  sphere_geometric,
  sphere_algebraic,
  sphere_in_range,
  plane,
  disk,
  box,
  slab,
};

struct KernelProbeCode {
  void (*run)(KernelId, int width, const KernelProbe&);
  std::span<const int> widths;
};

template <class A>
const KernelProbeCode& kernel_probe_code();

/// How many pairs at a time the kernels of `isa` can be run: 1 for the scalar set, else some of 4, 8 and 16.
/// Throws Error if this build holds no code for the set.
std::span<const int> probe_widths(Isa isa);
/// Runs a kernel on the code of `isa`, `width` pairs at a time, which must be one of probe_widths(isa).
void probe_kernel(Isa isa, KernelId id, int width, const KernelProbe& probe);

// ---- Root finders in lanes.

/// The root finders in lanes: closed forms, and all or the first of the certified roots.
enum class RootsKernel : std::uint8_t { closed2, closed3, closed4, all2, all3, all4, all6, first4 };

/// `count` polynomials to be solved in lanes, for verification and benchmarks: coefficients by power, ends of
/// the interval (not used by closed forms), and the answers by rank.
struct RootsProbe {
  std::size_t count = 0;
  const double* c[7] = {};
  const double* a = nullptr;
  const double* b = nullptr;
  double* x[6] = {};
  double* error[6] = {};
  /// Where no certificate could be given.
  std::uint8_t* unsure = nullptr;
};

template <class A>
void run_roots(RootsKernel id, const RootsProbe& probe);

/// Eight polynomials at a time; one on the scalar path. Throws Error if this build holds no code for the set.
void probe_roots(Isa isa, RootsKernel id, const RootsProbe& probe);

}  // namespace oktett
