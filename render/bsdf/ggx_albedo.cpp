#include "render/bsdf/ggx_albedo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <vector>

#include "core/math.h"
#include "render/bsdf/optics.h"
#include "render/bsdf/principled/base.h"
#include "render/sampling/warp.h"

namespace oktett {

// ---- Tables of directional albedos: the fraction of light from a direction that a rough surface sends on.

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

namespace {

constexpr int kMirrorNodes = 32, kNodes = 24, kInsideNodes = 40, kNearOneNodes = 48;
using Lane = Simd<double, 1, ScalarIsa>;

Vec3d visible_normal(const Vec3d& w, double alpha, double x, double y) {
  return only_lane(ggx_normal(broadcast<Lane>(w), Lane(alpha), Lane(1), Lane(x), Lane(y)));
}
double lambda_of(const Vec3d& w, double alpha) {
  return only_lane(ggx_lambda(broadcast<Lane>(w), Lane(alpha)));
}
double lowered(double loss, double error) { return only_lane(lowered_loss(Lane(loss), error)); }

/// A rule for integrals over the unit square: a Fibonacci lattice made periodic by the substitution
/// t^2 (3 - 2t) in both directions (Sloan 1994). Weights add to 1.
struct Lattice {
  std::vector<SquareSample> point;
  std::vector<double> weight;

  /// Two successive Fibonacci numbers.
  Lattice(int generator, int points) : point(points), weight(points) {
    double sum = 0;
    for (int i = 0; i < points; ++i) {
      const double s = (i + 0.5) / points, t = (i * generator % points + 0.5) / points;
      point[i] = {s * s * (3 - 2 * s), t * t * (3 - 2 * t)};
      sum += weight[i] = s * (1 - s) * t * (1 - t);
    }
    for (double& w : weight) w /= sum;
  }
};

const Lattice& coarse_lattice() {
  static const Lattice lattice(233, 377);
  return lattice;
}
const Lattice& fine_lattice() {
  static const Lattice lattice(377, 610);
  return lattice;
}

/// Calls visit(weight, w, m, c) for points of the facet normals `m` visible from a direction `w` of cosine
/// `mu`, with c = w.m. The weights add to 1.
template <class Visit>
void for_each_facet(const Lattice& lattice, double mu, double alpha, Visit&& visit) {
  mu = std::max(mu, 1e-5);
  const Vec3d w{std::sqrt(1 - mu * mu), 0, mu};
  for (std::size_t i = 0; i < lattice.point.size(); ++i) {
    const SquareSample& p = lattice.point[i];
    // The other half of the circle mirrors this one.
    const Vec3d m = visible_normal(w, alpha, p.y / 2, p.x);
    visit(lattice.weight[i], w, m, dot(w, m));
  }
}

/// The mean of `value(w, m, c)`.
template <class Value>
double facet_mean(const Lattice& lattice, double mu, double alpha, Value&& value) {
  double sum = 0;
  for_each_facet(lattice, mu, alpha, [&](double weight, const Vec3d& w, const Vec3d& m, double c) {
    sum += weight * value(w, m, c);
  });
  return sum;
}

/// The fraction of visible facets' light along `out` that is not shadowed.
double unshadowed(double lambda_in, const Vec3d& out, double alpha) {
  return (1 + lambda_in) / (1 + lambda_in + lambda_of(out, alpha));
}

/// The albedo of facets that reflect the fraction `fresnel(c)`.
template <class Fresnel>
double reflected(double mu, double alpha, Fresnel&& fresnel_of) {
  return facet_mean(coarse_lattice(), mu, alpha, [&](const Vec3d& w, const Vec3d& m, double c) {
    const Vec3d out = m * (2 * c) - w;
    return out.z > 0 ? fresnel_of(c) * unshadowed(lambda_of(w, alpha), out, alpha) : 0;
  });
}

double reflected_and_transmitted(double mu, double alpha, double eta) {
  // From inside, Fresnel's reflectance has a kink at the critical angle.
  const Lattice& lattice = eta < 1 ? fine_lattice() : coarse_lattice();
  return facet_mean(lattice, mu, alpha, [&](const Vec3d& w, const Vec3d& m, double c) {
    const double lambda = lambda_of(w, alpha), f = fresnel(c, eta);
    const Vec3d up = m * (2 * c) - w;
    const double reflected = up.z > 0 ? f * unshadowed(lambda, up, alpha) : 0;
    if (f >= 1) return reflected;
    const Vec3d down = m * (c / eta - std::sqrt(1 - (1 - c * c) / (eta * eta))) - w * (1 / eta);
    return down.z < 0 ? reflected + (1 - f) * unshadowed(lambda, down, alpha) : reflected;
  });
}

struct MirrorTables {
  AlbedoTable albedo{kMirrorNodes, NodeWidth::alpha, [](double mu, double alpha) {
                       return reflected(mu, alpha, [](double) { return 1.0; });
                     }};
  double at(double mu, double alpha) const { return 1 - lowered(1 - albedo.at(mu, alpha), kMirrorError); }
  LossTable loss{4, [this](double mu, double alpha) { return at(mu, alpha); }};
};

const MirrorTables& mirror_tables() {
  static const MirrorTables tables;
  return tables;
}

/// The width of the facets whose lobe resembles that of the light which facets of width `alpha` send to each
/// other: the one that comes closest to random walks between facets (docs/light.md).
double multiple_width(double alpha) { return std::min(1.0, 1.2 * std::sqrt(alpha)); }

/// The albedo of mirroring facets of width `width`, split by the light that they show: [viewer][light], both
/// at the nodes. Light between two nodes counts for both, by its place.
std::vector<double> albedo_by_light(const AlbedoNodes& nodes, double width) {
  const std::size_t n = nodes.count;
  std::vector<double> share(n * n);
  for (std::size_t viewer = 0; viewer < n; ++viewer)
    for_each_facet(coarse_lattice(), nodes.mu(viewer), width,
                   [&](double weight, const Vec3d& w, const Vec3d& m, double c) {
                     const Vec3d light = m * (2 * c) - w;
                     if (light.z <= 0) return;
                     const double seen = weight * unshadowed(lambda_of(w, width), light, width);
                     const Lane place = nodes.place(Lane(light.z)), node = nodes.node_before(place);
                     const double part = only_lane(place - node);
                     double* shares = &share[viewer * n + static_cast<std::size_t>(only_lane(node))];
                     shares[0] += seen * (1 - part), shares[1] += seen * part;
                   });
  return share;
}

/// MirrorMultipleScattering::scale at the nodes, times the roughness, so that interpolation between
/// roughnesses errs less. Sinkhorn's iteration (1964): sets each scale so that the lobe has the wanted
/// albedo, until none changes.
std::vector<double> multiple_scales(const AlbedoNodes& nodes, double alpha) {
  const std::size_t n = nodes.count;
  const std::vector<double> share = albedo_by_light(nodes, multiple_width(alpha));
  std::vector<double> scale(n, 1), loss(n);
  for (std::size_t i = 0; i < n; ++i) loss[i] = 1 - mirror_tables().at(nodes.mu(i), alpha);
  constexpr int kMostRounds = 100;
  double change = 1;
  for (int round = 0; change > 1e-6 && round < kMostRounds; ++round) {
    change = 0;
    for (std::size_t i = 0; i < n; ++i) {
      double albedo = 0;
      for (std::size_t k = 0; k < n; ++k) albedo += share[i * n + k] * scale[k];
      const double next = std::sqrt(scale[i] * loss[i] / albedo);
      change = std::max(change, std::abs(next - scale[i]));
      scale[i] = next;
    }
  }
  for (double& s : scale) s *= std::sqrt(alpha);
  return scale;
}

const AlbedoTable& multiple_table() {
  static const AlbedoTable table = AlbedoTable::by_width(kMirrorNodes, NodeWidth::alpha, multiple_scales);
  return table;
}

/// Tables are kept for some values of the amplitude that is reflected head-on, |eta - 1| / (eta + 1), counted
/// in steps of this size. It is 16 steps for eta = 1.5.
constexpr double kStep = 1 / 80.0;
constexpr int kSteps = 48;

/// The numbers of steps for which there are tables, in increasing order.
using Grid = std::vector<double>;
constexpr int kFewSteps = 3;

/// Each step from kFewSteps on. For a small amplitude r, a dielectric begins to mirror at angles of about
/// 2 sqrt(r) from grazing. Where facets are as wide as that, their albedo changes with the logarithm of r. So
/// below kFewSteps there are four tables for each octave, down to `least` steps.
Grid grid_from(double least) {
  constexpr double kFourths[] = {1, 0.8408964152537145, 0.7071067811865476, 0.5946035575013605};
  Grid steps;
  for (double octave = 2; octave > least; octave /= 2)
    for (const double part : kFourths) steps.insert(steps.begin(), octave * part);
  steps.push_back(2.5);
  for (int i = kFewSteps; i <= kSteps; ++i) steps.push_back(i);
  return steps;
}

double ior_of_steps(double steps) {
  const double r = steps * kStep;
  return (1 + r) / (1 - r);
}

/// Whether the grid is closer at this index.
bool near_one(double eta) { return std::abs(eta - 1) / (eta + 1) < (kFewSteps - 0.01) * kStep; }

/// The tables at place `i` of their grid, for an index above 1 or, if `inside`, for one below. Made when
/// first used.
template <class Tables>
const Tables& tables_at(int i, bool inside) {
  static const std::size_t size = Tables::grid().size();
  static std::vector<std::once_flag> once(2 * size);
  static std::vector<std::unique_ptr<const Tables>> made(2 * size);
  const std::size_t k = inside ? size + i : i;
  std::call_once(once[k], [&] {
    const double steps = Tables::grid()[i];
    made[k] = std::make_unique<const Tables>(ior_of_steps(inside ? -steps : steps));
  });
  return *made[k];
}

/// Two tables between which an albedo is interpolated, for indices of refraction.
template <class Tables>
struct TablePair {
  const Tables *first, *second;
  double place;  ///< 0: the first, 1: the second

  /// `loss(table)`, interpolated.
  template <class Loss>
  double mean(Loss&& loss) const {
    const double here = loss(*first);
    return first == second ? here : here + (loss(*second) - here) * place;
  }
  /// `table` is the member of Tables.
  AlbedoRows rows(AlbedoTable Tables::*table, double alpha) const {
    return {(first->*table).row(alpha), (second->*table).row(alpha), first != second, place};
  }
};

template <class Tables>
TablePair<Tables> tables_for(double eta) {
  const Grid& grid = Tables::grid();
  const bool inside = eta < 1;
  const double x = std::clamp(std::abs(eta - 1) / (eta + 1) / kStep, grid.front(), grid.back());
  const auto next = std::upper_bound(grid.begin() + 1, grid.end() - 1, x);
  const int above = static_cast<int>(next - grid.begin());
  const auto table = [&](int i) { return &tables_at<Tables>(i, inside); };
  const double gap = grid[above] - grid[above - 1];
  // Close to the index of a table, as indices given in float are, that table is enough.
  for (const int i : {above - 1, above})
    if (std::abs(x - grid[i]) < 1e-4 * std::min(gap, 1.0)) return {table(i), table(i), 0};
  if (inside) return {table(above), table(above - 1), (grid[above] - x) / gap};
  return {table(above - 1), table(above), (x - grid[above - 1]) / gap};
}

}  // namespace

MirrorAlbedo::MirrorAlbedo(double alpha)
    : row_(mirror_tables().albedo.row(alpha)), mean_loss_(alpha > 0 ? mirror_tables().loss.at(alpha) : 0) {}

MirrorMultipleScattering::MirrorMultipleScattering(double alpha)
    : row_(multiple_table().row(alpha)), alpha_(multiple_width(alpha)), factor_(1 / std::sqrt(alpha)) {}

/// The table holds how the albedo differs from that of the smooth interface times that of mirrors, which it
/// tends to for small alpha.
struct ReflectedAlbedo::Tables {
  double eta;
  AlbedoTable difference;
  LossTable loss;
  double smooth_loss;

  explicit Tables(double ior)
      : eta(ior),
        difference(near_one(ior) ? kNearOneNodes : kNodes,
                   near_one(ior) ? NodeWidth::three_quarters : NodeWidth::alpha,
                   [&](double mu, double alpha) {
                     return reflected(mu, alpha, [&](double c) { return fresnel(c, eta); }) -
                            like_smooth(mu, alpha, eta);
                   }),
        loss(0, [&](double mu, double alpha) { return at(mu, alpha, eta); }) {
    constexpr int kPoints = 256;
    smooth_loss = 0;
    for (int i = 0; i < kPoints; ++i) {
      const double mu = (i + 0.5) / kPoints;
      smooth_loss += (1 - fresnel(mu, eta)) * 2 * mu / kPoints;
    }
  }
  /// Also for the index 1, which reflects nothing. The next one reflects only at angles below 0.1 degrees.
  static const Grid& grid() {
    static const Grid grid = [] {
      Grid steps = grid_from(1e-4);
      steps.insert(steps.begin(), 0);
      return steps;
    }();
    return grid;
  }
  static double like_smooth(double mu, double alpha, double eta) {
    return mirror_tables().albedo.at(mu, alpha) * fresnel(mu, eta);
  }
  /// For an interface of index `ior` close to this table's.
  double at(double mu, double alpha, double ior) const {
    const double r = std::clamp(like_smooth(mu, alpha, ior) + difference.at(mu, alpha), 0.0, 1.0);
    return r + kReflectedError * (1 - r) * r / (r + 0.02);
  }
};

ReflectedAlbedo::ReflectedAlbedo(double eta, double alpha) : eta_(eta), alpha_(alpha) {
  const auto tables = tables_for<Tables>(eta);
  mean_loss_ = tables.mean([&](const Tables& t) { return alpha == 0 ? t.smooth_loss : t.loss.at(alpha); });
  if (alpha == 0) return;
  mirror_ = mirror_tables().albedo.row(alpha);
  rows_ = tables.rows(&Tables::difference, alpha);
}

struct GlassAlbedo::Tables {
  AlbedoTable albedo;
  LossTable loss;

  explicit Tables(double eta)
      : albedo(nodes(eta), width(eta),
               [=](double mu, double alpha) { return reflected_and_transmitted(mu, alpha, eta); }),
        loss(4, [this](double mu, double alpha) { return at(mu, alpha); }) {}
  // From inside, the albedo has a bend near the critical angle, far from grazing. For an index near 1 and the
  // widest facets, another one is near the normal.
  static int nodes(double eta) { return eta > 1 ? kNodes : near_one(eta) ? kNearOneNodes : kInsideNodes; }
  static NodeWidth width(double eta) {
    return eta > 1 ? NodeWidth::three_quarters : near_one(eta) ? NodeWidth::six_roots : NodeWidth::root;
  }
  /// Down to what counts as smooth glass.
  static const Grid& grid() {
    static const Grid grid = grid_from(kLeastIorDifference / (2 + kLeastIorDifference) / kStep);
    return grid;
  }
  double at(double mu, double alpha) const { return 1 - lowered(1 - albedo.at(mu, alpha), kGlassError); }
};

GlassAlbedo::GlassAlbedo(double eta, double alpha) {
  const auto tables = tables_for<Tables>(eta);
  mean_loss_ = tables.mean([&](const Tables& t) { return t.loss.at(alpha); });
  rows_ = tables.rows(&Tables::albedo, alpha);
}

double mean_fresnel(double eta) {
  // Close to 1 the formula's terms cancel.
  if (eta < 1.001) return (eta - 1) * (1 / 3.0 - 3 * (eta - 1));
  const double e2 = eta * eta, e3 = e2 * eta, e4 = e2 * e2, sum = e2 + 1, difference = e4 - 1;
  return 0.5 + (eta - 1) * (3 * eta + 1) / (6 * (eta + 1) * (eta + 1)) +
         e2 * (e2 - 1) * (e2 - 1) / (sum * sum * sum) * portable::log((eta - 1) / (eta + 1)) -
         2 * e3 * (e2 + 2 * eta - 1) / (sum * difference) +
         8 * e4 * (e4 + 1) / (sum * difference * difference) * portable::log(eta);
}

}  // namespace oktett
