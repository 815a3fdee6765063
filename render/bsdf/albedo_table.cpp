#include "render/bsdf/albedo_table.h"

#include <algorithm>
#include <cmath>

namespace oktett {

/// Narrower facets count as being this wide. The delta lobes begin well above.
static constexpr double kLeastTabledRoughness = 0.01;

static double mix(double a, double b, double t) { return a + (b - a) * t; }

/// Splits `x` in [0, last] into the index of an interval and the place in it.
static int interval(double& x, int last) {
  const int i = std::clamp(static_cast<int>(x), 0, last - 1);
  x -= i;
  return i;
}

double AlbedoNodes::mu(int node) const {
  if (node == count - 1) return 1;
  const double y = static_cast<double>(node) / (count - 1);
  return y * y * width / (1 + width - y * y);
}

double AlbedoTable::node_alpha(int j) const {
  const double rho = std::max(kLeastTabledRoughness, static_cast<double>(j) / (nodes_ - 1));
  return rho * rho;
}

static double width_of(NodeWidth width, double alpha) {
  if (width == NodeWidth::alpha) return alpha;
  const double rho = std::sqrt(alpha);
  if (width == NodeWidth::three_quarters) return rho * std::sqrt(rho);
  return width == NodeWidth::root ? rho : 6 * rho;
}

AlbedoNodes AlbedoTable::nodes_for(double alpha) const { return {nodes_, width_of(width_, alpha)}; }

AlbedoRow AlbedoTable::row(double alpha) const {
  const double rho = std::sqrt(alpha);
  double y = rho * (nodes_ - 1);
  const int j = interval(y, nodes_ - 1);
  return {&value_[j], nodes_for(alpha), y};
}

double AlbedoTable::at(double mu, double alpha) const {
  return only_lane(row(alpha).at(Simd<double, 1, ScalarIsa>(mu)));
}

double LossTable::node_roughness(int j) {
  return std::max(kLeastTabledRoughness, static_cast<double>(j) / (kNodes - 1));
}

double LossTable::scale(double rho) const {
  double scale = 1;
  for (int i = 0; i < power_; ++i) scale *= rho;
  return scale;
}

double LossTable::at(double alpha) const {
  const double rho = std::max(kLeastTabledRoughness, std::sqrt(alpha));
  double x = rho * (kNodes - 1);
  const int j = interval(x, kNodes - 1);
  return mix(value_[j], value_[j + 1], x) * scale(rho);
}

}  // namespace oktett
