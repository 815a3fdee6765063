#pragma once
/// \file The hot code of one instruction set, as functions. Each set compiles the files of
/// accel/isa with flags of its own and OKTETT_ISA as its tag.

#include "accel/accel.h"
#include "accel/build_sah.h"
#include "accel/hit_list.h"
#include "accel/mesh_surfaces.h"
#include "accel/shape_hits.h"
#include "accel/trace_mode.h"
#include "accel/view_rays.h"
#include "core/isa.h"

namespace oktett {

/// A kernel to be run by itself on `count` pairs of a ray and a shape, for verification and benchmarks. All
/// columns hold `count` elements; hit[i] becomes 1 or 0, and t, u, v are defined where it is 1.
struct KernelRun {
  std::size_t count = 0;
  RaySpan rays;
  const float* corner[3][3] = {};  ///< triangles: [corner][axis]
  const double* shape[12] = {};    ///< other shapes: the columns of their pool, in its order
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
  plane,
  disk,
  box,
  slab,
};

/// The root finders in lanes: closed forms, and all or the first of the certified roots.
enum class RootsKernel : std::uint8_t { closed2, closed3, closed4, all2, all3, all4, all6, first4 };

/// `count` polynomials to be solved in lanes, for verification and benchmarks: coefficients by power, ends of
/// the interval (not used by closed forms), and the answers by rank.
struct RootsRun {
  std::size_t count = 0;
  const double* c[7] = {};
  const double* a = nullptr;
  const double* b = nullptr;
  double* x[6] = {};
  double* error[6] = {};
  /// Where no certificate could be given.
  std::uint8_t* unsure = nullptr;
};

struct IsaTable {
  void (*closest_hit)(const Accel&, const RaySpan&, const HitSpan&, TraceMode);
  void (*any_hit)(const Accel&, const RaySpan&, std::uint8_t*, TraceMode);
  void (*all_hits)(const Accel&, const Ray&, HitList&);
  /// `width` is 1, 4, 8 or 16.
  void (*run_kernel)(KernelId, int width, const KernelRun&);
  BuildKernels build;
  /// Eight lanes; one on the scalar path.
  void (*run_roots)(RootsKernel, const RootsRun&);
  void (*view_directions)(const ViewPlane&, const ViewPoints&);
  void (*mesh_surfaces)(MeshSurfaces&);
  /// Spheres, planes, or one box.
  void (*closed_form_surfaces)(const Accel&, Kind, ShapeHits&);
  bool (*exact_surfaces)(const Accel&, Kind, ShapeHits&);
};

/// Null if this build holds no code for `isa`.
const IsaTable* isa_table(Isa isa);

/// Defined for each set `A` that this build holds.
template <class A>
const IsaTable& isa_code();

}  // namespace oktett
