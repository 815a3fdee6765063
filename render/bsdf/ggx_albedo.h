#pragma once
/// \file Directional albedos of single scattering by GGX facets. What they leave of 1 is the light that
/// facets send to other facets; the lobes of render/bsdf/principled_lobes.h give it back.
///
/// The albedos come from tables that are computed when they are first needed, by numerical integration in a
/// fixed order: 10 to 60 ms for each table. They are raised by a bound of their error, 0.1 to 0.5 %, so that
/// what is given back is never too much. Cosines are given in lanes, and are in (0, 1].

#include "render/bsdf/albedo_table.h"
#include "render/bsdf/lobe_lanes.h"
#include "render/bsdf/principled_parameters.h"

namespace oktett {

/// Bounds of the errors of the tables.
inline constexpr double kMirrorError = 0.001, kReflectedError = 0.0035, kGlassError = 0.0045;

/// `loss` lowered by at most `error`, but not to 0.
template <class D>
OKTETT_INLINE D lowered_loss(const D& loss, double error) {
  return select(loss > D(0.0), loss * (loss / (loss + D(error))), D(0.0));
}

/// Facets that reflect all light.
class MirrorAlbedo {
 public:
  MirrorAlbedo() = default;
  explicit MirrorAlbedo(double alpha);
  template <class D>
  OKTETT_INLINE D operator()(const D& mu) const {
    return D(1.0) - lowered_loss(D(1.0) - row_.at(mu), kMirrorError);
  }
  /// 1 - the albedo for diffuse light.
  double mean_loss() const { return mean_loss_; }

 private:
  AlbedoRow row_;
  double mean_loss_ = 0;
};

/// The light that mirroring facets send to each other before it leaves the surface. Its lobe is that of wider
/// facets, times scale(mu) for the viewer and for the light. So it is reciprocal. Its albedo is
/// 1 - MirrorAlbedo.
class MirrorAgain {
 public:
  MirrorAgain() = default;
  /// `alpha` > 0: the width of the mirroring facets.
  explicit MirrorAgain(double alpha);
  /// Of the wider facets.
  double alpha() const { return alpha_; }
  template <class D>
  OKTETT_INLINE D scale(const D& mu) const {
    return row_.at(mu) * D(factor_);
  }

 private:
  AlbedoRow row_;
  double alpha_ = 0, factor_ = 0;
};

/// One or two tables between which an albedo is interpolated, for indices of refraction.
struct AlbedoRows {
  AlbedoRow first, second;
  bool both = false;
  double place = 0;  ///< 0: the first, 1: the second

  template <class Get, class D>
  OKTETT_INLINE D interpolated(const Get& get, const D& mu) const {
    const D here = get(first, mu);
    return both ? here + (get(second, mu) - here) * D(place) : here;
  }
};

/// The interface of a dielectric, reflected light only. `alpha` 0: the smooth interface.
class ReflectedAlbedo {
 public:
  struct Tables;
  ReflectedAlbedo() = default;
  /// `eta`: index of refraction, in [1, kMostIor].
  ReflectedAlbedo(double eta, double alpha);
  template <class D>
  OKTETT_INLINE D operator()(const D& mu) const {
    const D smooth = min(D(1.0), fresnel_lanes(mu, D(eta_)));
    if (alpha_ == 0) return smooth;
    const D like_smooth = mirror_.at(mu) * smooth;
    return rows_.interpolated(
        [&](const AlbedoRow& row, const D& cosine) { return raised(like_smooth + row.at(cosine)); }, mu);
  }
  double mean_loss() const { return mean_loss_; }

 private:
  template <class D>
  static OKTETT_INLINE D raised(const D& albedo) {
    const D r = within(albedo, D(0.0), D(1.0));
    return r + D(kReflectedError) * (D(1.0) - r) * r / (r + D(0.02));
  }

  double eta_ = 1, alpha_ = 0, mean_loss_ = 0;
  AlbedoRow mirror_;
  AlbedoRows rows_;  ///< how the albedo differs from that of the smooth interface times that of mirrors
};

/// The interface of a dielectric, reflected and transmitted light together.
class GlassAlbedo {
 public:
  struct Tables;
  GlassAlbedo() = default;
  /// `eta`: index of refraction behind the interface relative to that before it, in [1 / kMostIor, kMostIor].
  GlassAlbedo(double eta, double alpha);
  template <class D>
  OKTETT_INLINE D operator()(const D& mu) const {
    return rows_.interpolated(
        [](const AlbedoRow& row, const D& cosine) {
          return D(1.0) - lowered_loss(D(1.0) - row.at(cosine), kGlassError);
        },
        mu);
  }
  double mean_loss() const { return mean_loss_; }

 private:
  double mean_loss_ = 0;
  AlbedoRows rows_;
};

/// The fraction of diffuse light that a smooth dielectric of index `eta` >= 1 reflects (Walsh 1926). From
/// inside it is 1 - (1 - that) / eta^2.
double mean_fresnel(double eta);

}  // namespace oktett
