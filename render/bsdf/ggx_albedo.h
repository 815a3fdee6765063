#pragma once
/// \file GGX facets: their distribution, and directional albedos of single scattering by them. What they
/// leave of 1 is the light that facets send to other facets; the lobes of render/bsdf/principled_lobes.h give
/// it back.
///
/// The albedos come from tables that are computed when they are first needed, by numerical integration in a
/// fixed order: 10 to 60 ms for each table. They are raised by a bound of their error, 0.1 to 0.5 %, so that
/// what is given back is never too much. Cosines are given in lanes, and are in (0, 1].

#include <vector>

#include "core/elementary.h"
#include "core/lanes.h"
#include "core/simd_memory.h"
#include "render/bsdf/lobe_lanes.h"
#include "render/bsdf/principled_parameters.h"

namespace oktett {

// ---- The GGX microfacet distribution (Trowbridge and Reitz 1975; Walter 2007), isotropic, with Smith's
// height-correlated masking and shadowing (Heitz 2014), in lanes.
//
// All directions have unit length; z is the normal of the surface. `alpha` > 0 is the width of the
// distribution: the root mean square of the facets' slopes has that order.

/// The density of facet normals `m`, per solid angle of `m`, such that the facets cover the surface once:
/// the integral of D(m) m.z is 1.
template <class D>
OKTETT_INLINE D ggx_density(const Vec3<D>& m, const D& alpha) {
  const D a2 = alpha * alpha;
  // From x and y rather than from 1 - z^2, which cancels near the normal.
  const D t = (m.x * m.x + m.y * m.y) + a2 * (m.z * m.z);
  return a2 / (D(std::numbers::pi) * t * t);
}

/// Smith's Lambda for GGX: the area of hidden facets relative to that of visible ones, from direction `w` on
/// either side of the surface (Heitz 2014, equation 72). Infinite along the surface.
template <class D>
OKTETT_INLINE D ggx_lambda(const Vec3<D>& w, const D& alpha) {
  const D tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z), a2t2 = alpha * alpha * tan2;
  const D root = sqrt(D(1.0) + a2t2), two(2.0);
  // (sqrt(1 + x) - 1) / 2 without cancellation.
  return select(a2t2 > D(1.0), (root - D(1.0)) / two, a2t2 / (two * (D(1.0) + root)));
}

/// How far down the cap of visible normals goes of which facets may reflect above the surface, relative to
/// the whole cap (Eto 2023).
template <class D>
OKTETT_INLINE D reflecting_bound(const Vec3<D>& w, const D& alpha) {
  const D s = D(1.0) + sqrt(w.x * w.x + w.y * w.y), s2 = s * s, a2 = alpha * alpha;
  return (D(1.0) - a2) * s2 / (s2 + a2 * w.z * w.z);
}

/// The reflected direction of ggx_normal with reflecting_bound, if it lies above the surface, has the
/// density D(m) times this.
template <class D>
OKTETT_INLINE D ggx_reflected_scale(const Vec3<D>& w, const D& alpha) {
  const D size = length_lanes(Vec3<D>{alpha * w.x, alpha * w.y, w.z});
  return D(1.0) / (D(2.0) * (reflecting_bound(w, alpha) * w.z + size));
}

/// A facet normal visible from `w`, w.z > 0, with density D(m) max(0, w.m) / ((1 + Lambda(w)) w.z): the point
/// (x: azimuth, y: height) of the cap from the pole down to z = -bound of a stretched sphere (Dupuy 2023).
/// `bound` is 1 or reflecting_bound.
template <class D>
OKTETT_INLINE Vec3<D> ggx_normal(const Vec3<D>& w, const D& alpha, const D& bound, const D& x, const D& y) {
  const Vec3<D> stretched = unit_lanes(Vec3<D>{alpha * w.x, alpha * w.y, w.z});
  // z = 1 - below; the sine from `below`, so that it keeps its digits near the pole.
  const D below = y * (D(1.0) + bound * stretched.z);
  const D size = sqrt(max(D(0.0), below * (D(2.0) - below)));
  D sine, cosine;
  sin_cos_of_turn(x, sine, cosine);
  const Vec3<D> halfway = Vec3<D>{size * cosine, size * sine, D(1.0) - below} + stretched;
  return unit_lanes(Vec3<D>{alpha * halfway.x, alpha * halfway.y, max(D(0.0), halfway.z)});
}

// ---- Tables of directional albedos: the fraction of light from a direction that a rough surface sends on.

/// Cosines mu in [0, 1] at which a table has values.
struct AlbedoNodes {
  int count = 1;
  double width = 0;  ///< of the range of mu where nodes lie close together

  double mu(int node) const;
  /// The place of `mu` among the nodes, [0, count - 1], in lanes.
  template <class D>
  OKTETT_INLINE D place(const D& mu) const {
    const D w(width);
    return sqrt(mu * (D(1.0) + w) / (mu + w)) * D(count - 1);
  }
  /// The node before a place, but not the last one.
  template <class D>
  OKTETT_INLINE D node_before(const D& place) const {
    return within(whole_part(place), D(0.0), D(count - 2));
  }
};

/// An AlbedoTable at one width of the facets.
struct AlbedoRow {
  const float* values = nullptr;  ///< of the first node for mu, at the node for alpha before the width
  AlbedoNodes nodes;
  double part = 0;  ///< place between the node for alpha and the next, [0, 1]

  /// The quantity at `mu` in [0, 1], in lanes.
  template <class D>
  OKTETT_INLINE D at(const D& mu) const {
    const D place = nodes.place(mu), node = nodes.node_before(place), offset = node * D(nodes.count),
            mix(part);
    const auto value = [&](int more) {
      const D before = gather(values + more, offset), after = gather(values + more + 1, offset);
      return before + (after - before) * mix;
    };
    const D near = value(0), far = value(nodes.count);
    return near + (far - near) * (place - node);
  }
};

/// Up to which mu nodes of an AlbedoTable lie close together: a power of alpha, or six times its root.
enum class NodeWidth { alpha, three_quarters, root, six_roots };

/// A quantity by the cosine `mu` of a direction with the normal and by the width `alpha` of the facets, both
/// in [0, 1]. Linear between nodes that lie close together where the quantity changes fast. That is where mu
/// is at most of the order of the table's power of alpha; with a lower power the other nodes are closer.
class AlbedoTable {
 public:
  AlbedoTable() = default;
  /// `entry(mu, alpha)` gives the values at the nodes.
  template <class Entry>
  AlbedoTable(int nodes, NodeWidth width, Entry&& entry)
      : AlbedoTable(by_width(nodes, width, [&](const AlbedoNodes& at, double alpha) {
          std::vector<double> values(nodes);
          for (int i = 0; i < nodes; ++i) values[i] = entry(at.mu(i), alpha);
          return values;
        })) {}
  /// `entries(nodes, alpha)` gives the values at all nodes for mu at once.
  template <class Entries>
  static AlbedoTable by_width(int nodes, NodeWidth width, Entries&& entries) {
    AlbedoTable table;
    table.nodes_ = nodes, table.width_ = width, table.value_.resize(nodes * nodes);
    for (int j = 0; j < nodes; ++j) {
      const double alpha = table.node_alpha(j);
      const std::vector<double> values = entries(table.nodes_for(alpha), alpha);
      for (int i = 0; i < nodes; ++i) table.value_[i * nodes + j] = static_cast<float>(values[i]);
    }
    return table;
  }

  AlbedoRow row(double alpha) const;
  double at(double mu, double alpha) const;

 private:
  double node_alpha(int j) const;
  AlbedoNodes nodes_for(double alpha) const;

  int nodes_ = 0;
  NodeWidth width_ = NodeWidth::alpha;
  std::vector<float> value_;  ///< [mu][alpha]
};

/// What a rough surface loses of diffuse light, the mean of 1 - albedo weighted by 2 mu, by the width of the
/// facets.
class LossTable {
 public:
  LossTable() = default;
  /// `albedo(mu, alpha)` is integrated at each node. `power`: the loss behaves like this power of the
  /// roughness, the root of alpha, near 0.
  template <class Albedo>
  LossTable(int power, Albedo&& albedo) : power_(power), value_(kNodes) {
    for (int j = 0; j < kNodes; ++j) {
      const double rho = node_roughness(j);
      double sum = 0;
      // mu = y^4 puts as many points where mu is as small as alpha as elsewhere.
      for (int i = 0; i < kPoints; ++i) {
        const double y = (i + 0.5) / kPoints, mu = y * y * y * y;
        sum += (1 - albedo(mu, rho * rho)) * 8 * mu * mu / y;
      }
      value_[j] = sum / kPoints / scale(rho);
    }
  }

  double at(double alpha) const;

 private:
  static constexpr int kNodes = 64, kPoints = 64;
  static double node_roughness(int j);
  double scale(double rho) const;

  int power_ = 0;
  std::vector<double> value_;
};

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
class MirrorMultipleScattering {
 public:
  MirrorMultipleScattering() = default;
  /// `alpha` > 0: the width of the mirroring facets.
  explicit MirrorMultipleScattering(double alpha);
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
