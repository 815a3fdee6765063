#include "verify/probes/kernel_probe.h"
#include "accel/ray_state.h"
#include "accel/traverse/leaf.h"
#include "verify/isa/load_column.h"

namespace oktett {

// ---- Single kernels over columns of rays and shapes, W pairs at a time, for one instruction set.

template <class F>
OKTETT_INLINE void store_results(const KernelProbe& run, std::size_t b, unsigned lanes,
                                 const HitLanes<F>& h) {
  constexpr int W = F::kWidth;
  float t[W], u[W], v[W];
  h.t.store(t), h.u.store(u), h.v.store(v);
  for (int i = 0; i < W && b + i < run.count; ++i) {
    run.hit[b + i] = lanes >> i & 1;
    run.t[b + i] = t[i], run.u[b + i] = u[i], run.v[b + i] = v[i];
  }
}

template <int W, class A>
void run_triangle(TriangleTest test, const KernelProbe& run) {
  using F = Simd<float, W, A>;
  RayState<W, A> state;
  for (std::size_t b = 0; b < run.count; b += W) {
    const RayLanes<F> ray = load_span<F>(run.rays, b);
    TriangleLanes<F> tri;
    Vec3<F>* corners[3] = {&tri.a, &tri.b, &tri.c};
    for (int k = 0; k < 3; ++k)
      *corners[k] = {load_column<F>(run.corner[k][0], b, run.count),
                     load_column<F>(run.corner[k][1], b, run.count),
                     load_column<F>(run.corner[k][2], b, run.count)};
    const unsigned valid = state.set(ray.o, ray.d, ray.tmin, ray.tmax, Box{});
    HitLanes<F> h{F(0.0f), F(0.0f), F(0.0f)};
    unsigned lanes = 0;
    if (test != TriangleTest::watertight) {
      lanes = bits(textbook_test(test, ray, tri, h)) & valid;
    } else {
      const unsigned maybe = valid & bits(filter_watertight(ray, F::load(state.d_max), filter_triangle(tri)));
      // Lanes of one greatest axis are decided together, as in a packet.
      for (int z = 0; z < 3; ++z) {
        const unsigned group = maybe & state.z_axis[z];
        if (group == 0) continue;
        HitLanes<F> hz{F(0.0f), F(0.0f), F(0.0f)};
        const TriangleLanes<F> permuted{permute_to_z(tri.a, z), permute_to_z(tri.b, z),
                                        permute_to_z(tri.c, z)};
        const unsigned hits =
            group & bits(decide_watertight(load_shear(state, z), permuted, ray.tmin, ray.tmax, hz));
        const auto m = F::M::from_bits(hits);
        h = {select(m, hz.t, h.t), select(m, hz.u, h.u), select(m, hz.v, h.v)};
        lanes |= hits;
      }
    }
    store_results(run, b, lanes, h);
  }
}

/// A sphere solved by the algebraic method, so that first_root can be asked for it.
struct AlgebraicSphere : Sphere {
  template <class D>
  OKTETT_INLINE static typename D::M roots(const RayLanes<D>& ray, const Lanes<D>& s, D (&t)[2]) {
    return roots_algebraic(ray, s, t);
  }
};

/// A sphere whose roots are found only where they may be on the ray, as for rays in flight.
struct SphereInRange : Sphere {
  template <class D>
  OKTETT_INLINE static typename D::M roots(const RayLanes<D>& ray, const Lanes<D>& s, D (&t)[2]) {
    return roots_in_range(ray, D(1.0) / dot_lanes(ray.d, ray.d), last_root(ray.tmax), s, t);
  }
};

template <class S, int W, class A>
void run_shape(const KernelProbe& run) {
  using F = Simd<float, W, A>;
  using D = Simd<double, W, A>;
  RayState<W, A> state;
  for (std::size_t b = 0; b < run.count; b += W) {
    const RayLanes<F> ray = load_span<F>(run.rays, b);
    const unsigned valid = state.set(ray.o, ray.d, ray.tmin, ray.tmax, Box{});
    const auto shape =
        S::template lanes<D>([&](int k) { return load_column<D>(run.shape[k], b, run.count); });
    HitLanes<F> h;
    const auto found = first_root<S>(ray, to_double(ray), shape, h);
    store_results(run, b, bits(found) & valid, h);
  }
}

/// Boxes as lo (columns 0-2 of `corner[0]`) and hi (`corner[1]`): t becomes the near distance.
template <int W, class A>
void run_slab(const KernelProbe& run) {
  using F = Simd<float, W, A>;
  RayState<W, A> state;
  for (std::size_t b = 0; b < run.count; b += W) {
    const RayLanes<F> ray = load_span<F>(run.rays, b);
    float extent = 0;
    for (std::size_t i = b; i < b + W && i < run.count; ++i)
      for (int k = 0; k < 6; ++k) {
        const float e = __builtin_fabsf(run.corner[k / 3][k % 3][i]);
        extent = e > extent ? e : extent;
      }
    const Box scene{{-extent, -extent, -extent}, {extent, extent, extent}};
    const unsigned valid = state.set(ray.o, ray.d, ray.tmin, ray.tmax, scene);
    F near_planes[3], far_planes[3];
    for (int k = 0; k < 3; ++k) {
      const F lo = load_column<F>(run.corner[0][k], b, run.count),
              hi = load_column<F>(run.corner[1][k], b, run.count);
      const auto negative = F::M::from_bits(state.negative[k]);
      near_planes[k] = select(negative, hi, lo), far_planes[k] = select(negative, lo, hi);
    }
    F n, f;
    slab_interval({F::load(state.o[0]), F::load(state.o[1]), F::load(state.o[2])},
                  {F::load(state.inv[0]), F::load(state.inv[1]), F::load(state.inv[2])}, near_planes,
                  far_planes, ray.tmin, ray.tmax, F::load(state.slack), n, f);
    store_results(run, b, bits(n <= f) & valid, HitLanes<F>{n, F(0.0f), F(0.0f)});
  }
}

template <int W, class A>
void run_kernel_width(KernelId id, const KernelProbe& run) {
  // The triangle tests come first, the other kernels follow in the order of KernelId.
  if (id <= KernelId::triangle_segura_feito) return run_triangle<W, A>(static_cast<TriangleTest>(id), run);
  static constexpr void (*kShapes[])(const KernelProbe&) = {run_shape<Sphere, W, A>,
                                                            run_shape<AlgebraicSphere, W, A>,
                                                            run_shape<SphereInRange, W, A>,
                                                            run_shape<Plane, W, A>,
                                                            run_shape<Disk, W, A>,
                                                            run_shape<BoxSolid, W, A>,
                                                            run_slab<W, A>};
  kShapes[static_cast<int>(id) - static_cast<int>(KernelId::sphere_geometric)](run);
}

/// Code for the widths W of one set.
template <class A, int... W>
struct KernelProbeWidths {
  static constexpr int kWidths[] = {W...};
  static void run(KernelId id, int width, const KernelProbe& run) {
    ((width == W ? run_kernel_width<W, A>(id, run) : void()), ...);
  }
  static constexpr KernelProbeCode code = {run, kWidths};
};

/// One ray at a time is the same code in every set, so only the scalar set is probed at width 1. The other
/// sets are probed at the widths of the registers and packets that their traversal uses.
template <class A>
const KernelProbeCode& kernel_probe_code() {
  if constexpr (std::is_same_v<A, ScalarIsa>) return KernelProbeWidths<A, 1>::code;
  if constexpr (std::is_same_v<A, Sse42Isa> || std::is_same_v<A, NeonIsa>)
    return KernelProbeWidths<A, 4, 8>::code;
  if constexpr (std::is_same_v<A, Avx2Isa>) return KernelProbeWidths<A, 8>::code;
  if constexpr (std::is_same_v<A, Avx512Isa>) return KernelProbeWidths<A, 8, 16>::code;
}

template const KernelProbeCode& kernel_probe_code<OKTETT_ISA>();

}  // namespace oktett
