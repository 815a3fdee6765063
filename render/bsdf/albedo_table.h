#pragma once
/// \file Tables of directional albedos: the fraction of light from a direction that a rough surface sends on.

#include <vector>

namespace oktett {

/// A quantity in [0, 1] by the cosine `mu` of a direction with the normal and by the width `alpha` of the
/// facets, both in [0, 1]. Linear between nodes that lie close together where the quantity changes fast:
/// where mu is of the order of `alpha` or, for wide tables, of its root.
class AlbedoTable {
 public:
  AlbedoTable() = default;
  /// `entry(mu, alpha)` gives the values at the nodes.
  template <class Entry>
  AlbedoTable(int nodes, bool wide, Entry&& entry) : nodes_(nodes), wide_(wide), value_(nodes * nodes) {
    for (int i = 0; i < nodes; ++i)
      for (int j = 0; j < nodes; ++j) {
        const double alpha = node_alpha(j);
        value_[i * nodes + j] = static_cast<float>(entry(node_mu(i, alpha), alpha));
      }
  }

  double at(double mu, double alpha) const;

 private:
  double node_alpha(int j) const;
  double node_mu(int i, double alpha) const;

  int nodes_ = 0;
  bool wide_ = false;
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
