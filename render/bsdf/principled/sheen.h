#pragma once
/// \file The sheen of the principled material: light scattered by short fibres upon a surface, after Zeltner
/// 2022. The lobe is a clamped cosine under a linear map that depends on the viewer, so it is not reciprocal.
/// The coefficients are the rational fits of the MaterialX library to the paper's tables.

#include "render/bsdf/principled/base.h"
#include "render/sampling/warp.h"

namespace oktett {

/// Fibres as one viewer sees them.
class SheenFibres {
 public:
  SheenFibres() = default;
  /// `wo`: the unit direction to the viewer, wo.z > 0. `roughness`: [0, 1]; small values show at grazing
  /// angles only.
  SheenFibres(const Vec3d& wo, double roughness);

  /// The fraction of light from the viewer's direction that the fibres scatter; the rest passes below.
  double albedo() const { return albedo_; }
  /// f cos / albedo: the density per solid angle of the directions that `sample` gives; its integral is 1.
  double density(const Vec3d& wi) const;
  Vec3d sample(const SquareSample& u) const;

 private:
  double albedo_ = 0;
  double a_ = 1, b_ = 0;          ///< of the map to a cosine: x' = a x + b z, y' = a y, z' = z
  double cosine_ = 1, sine_ = 0;  ///< of the viewer's azimuth
};

struct SheenSurface {
  SheenSurface() = default;
  OKTETT_INLINE SheenSurface(const PrincipledParameters& p, const PrincipledBase& base) {
    if (!base.outside) return;
    color = limited(p.sheen_color, 0, 1) * limited(p.sheen, 0, 1);
    weight = max_component(color);
    roughness = limited(p.sheen_roughness, 0, 1);
  }
  Vec3d color;
  double weight = 0;  ///< greatest component of color
  double roughness = 0;
};

template <class D>
class SheenLobe {
 public:
  using M = typename D::M;
  using Surface = SheenSurface;
  static constexpr int kChances = 1;

  static bool is_there(const Surface& s, const PrincipledBase&) { return s.weight > 0; }
  static bool is_delta(const Surface&, const PrincipledBase&) { return false; }

  OKTETT_INLINE void set(const Surface& s, const LobeView<D>& v, ArrivingLight<D>& arriving, D* chance) {
    double x[D::kWidth], y[D::kWidth], z[D::kWidth], albedo[D::kWidth];
    v.wo.x.store(x), v.wo.y.store(y), v.wo.z.store(z);
    for (int k = 0; k < D::kWidth; ++k) {
      fibres_[k] = SheenFibres({x[k], y[k], z[k]}, s.roughness);
      albedo[k] = fibres_[k].albedo();
    }
    albedo_ = D::load(albedo);
    *chance = D(s.weight) * albedo_;
    arriving.all = arriving.all - *chance;
  }

  OKTETT_INLINE void add_above(const Surface& s, const LobeView<D>&, const LobeLight<D>& light,
                               const D* chance, LobeSum<D>& sum) const {
    double x[D::kWidth], y[D::kWidth], z[D::kWidth], lanes[D::kWidth];
    light.wi.x.store(x), light.wi.y.store(y), light.wi.z.store(z);
    for (int k = 0; k < D::kWidth; ++k) lanes[k] = fibres_[k].density({x[k], y[k], z[k]});
    const D density = D::load(lanes);
    sum.value = sum.value + broadcast<D>(s.color) * (albedo_ * density);
    sum.pdf = sum.pdf + *chance * density;
  }

  OKTETT_INLINE void sample(const Surface&, const LobeView<D>&, int first, const D*,
                            LobeSampling<D>& out) const {
    const M here = out.chose(first);
    if (none(here)) return;
    double u[D::kWidth], v[D::kWidth], w[3][D::kWidth];
    out.x.store(u), out.y.store(v);
    for (int k = 0; k < D::kWidth; ++k) {
      const Vec3d direction = fibres_[k].sample({u[k], v[k]});
      for (int axis = 0; axis < 3; ++axis) w[axis][k] = direction[axis];
    }
    out.scatter(here, {D::load(w[0]), D::load(w[1]), D::load(w[2])});
  }

 private:
  D albedo_{0.0};
  SheenFibres fibres_[D::kWidth];
};

}  // namespace oktett
