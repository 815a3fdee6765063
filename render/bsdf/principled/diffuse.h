#pragma once
/// \file The diffuse part of the principled material: Lambert's law below the interface of the opaque
/// dielectric. It takes what the interface does not reflect, for the light's direction and for the viewer's
/// (Kelemen 2001).

#include "render/bsdf/principled/base.h"

namespace oktett {

struct DiffuseSurface {
  DiffuseSurface() = default;
  OKTETT_INLINE DiffuseSurface(const PrincipledParameters&, const PrincipledBase& base) {
    // Nothing passes an interface that reflects all.
    constexpr double kLeastLoss = 1e-9;
    if (base.opaque_loss > kLeastLoss) scale = 1 / (std::numbers::pi * base.opaque_loss);
  }
  double scale = 0;  ///< such that what passes the interface is scattered
};

template <class D>
class DiffuseLobe {
 public:
  using Surface = DiffuseSurface;
  static constexpr int kChances = 1;

  static bool is_there(const Surface&, const PrincipledBase& b) { return b.opaque > 0; }
  static bool is_delta(const Surface&, const PrincipledBase&) { return false; }

  OKTETT_INLINE void set(const Surface& s, const LobeView<D>& v, ArrivingLight<D>& arriving, D* chance) {
    weight_ = arriving.under_opaque * D(s.scale);
    *chance = arriving.under_opaque * D(v.base->tint);
  }

  OKTETT_INLINE void add_above(const Surface&, const LobeView<D>& v, const LobeLight<D>& light,
                               const D* chance, LobeSum<D>& sum) const {
    const D cosine = light.wi.z, passed = D(1.0) - v.base->opaque_albedo(light.wi);
    sum.value = sum.value + broadcast<D>(v.base->base_color) * (weight_ * passed * cosine);
    sum.pdf = sum.pdf + *chance * cosine * D(1 / std::numbers::pi);
  }

  OKTETT_INLINE void sample(const Surface&, const LobeView<D>&, int first, const D*,
                            LobeSampling<D>& out) const {
    if (const auto here = out.chose(first); any(here)) out.scatter(here, cosine_above(out.x, out.y));
  }

 private:
  D weight_{0.0};
};

}  // namespace oktett
