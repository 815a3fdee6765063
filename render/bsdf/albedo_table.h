#pragma once
/// \file Tables of directional albedos: the fraction of light from a direction that a rough surface sends on.

#include <vector>

#include "core/lane_math.h"
#include "core/simd_gather.h"

namespace oktett {

/// An AlbedoTable at one width of the facets.
struct AlbedoRow {
  const float* values = nullptr;  ///< of the first node for mu, at the node for alpha before the width
  int nodes = 1;
  double width = 0;  ///< of the range of mu where the quantity changes fast
  double part = 0;   ///< place between the node for alpha and the next, [0, 1]

  /// The quantity at `mu` in [0, 1], in lanes.
  template <class D>
  OKTETT_INLINE D at(const D& mu) const {
    const D w(width), last(nodes - 1), mix(part);
    const D x = sqrt(mu * (D(1.0) + w) / (mu + w)) * last;
    const D node = within(whole_part(x), D(0.0), last - D(1.0)), place = node * D(nodes);
    const auto value = [&](int offset) {
      const D before = gather(values + offset, place), after = gather(values + offset + 1, place);
      return before + (after - before) * mix;
    };
    const D near = value(0), far = value(nodes);
    return near + (far - near) * (x - node);
  }
};

/// Up to which mu nodes of an AlbedoTable lie close together: a power of alpha, or six times its root.
enum class NodeWidth { alpha, three_quarters, root, six_roots };

/// A quantity in [0, 1] by the cosine `mu` of a direction with the normal and by the width `alpha` of the
/// facets, both in [0, 1]. Linear between nodes that lie close together where the quantity changes fast. That
/// is where mu is at most of the order of the table's power of alpha; with a lower power the other nodes are
/// closer.
class AlbedoTable {
 public:
  AlbedoTable() = default;
  /// `entry(mu, alpha)` gives the values at the nodes.
  template <class Entry>
  AlbedoTable(int nodes, NodeWidth width, Entry&& entry)
      : nodes_(nodes), width_(width), value_(nodes * nodes) {
    for (int i = 0; i < nodes; ++i)
      for (int j = 0; j < nodes; ++j) {
        const double alpha = node_alpha(j);
        value_[i * nodes + j] = static_cast<float>(entry(node_mu(i, alpha), alpha));
      }
  }

  AlbedoRow row(double alpha) const;
  double at(double mu, double alpha) const;

 private:
  double node_alpha(int j) const;
  double node_mu(int i, double alpha) const;
  double width(double alpha) const;

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

}  // namespace oktett
