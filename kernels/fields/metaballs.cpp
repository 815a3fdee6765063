#include "kernels/fields/metaballs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "kernels/fields/blobtree.h"

namespace oktett {

namespace {

/// Cells are divided down to this, in radii of their smallest ball.
constexpr double kLeastBallSize = 0.5;
/// Times relative to that of a node, measured with 8 rays at once: a cell, each of its balls, and (guessed
/// from its operations) a ball that is no sphere.
constexpr double kBallCellCost = 6, kBallCost = 2, kFormCost = 8;

class BallRule : public CellRule {
 public:
  BallRule(const MetaballsPool& pool, double iso) : pool_(pool), iso_(iso) {}

  CellRange narrow(const CellBox& box, std::span<const std::uint32_t> part,
                   std::vector<std::uint32_t>& out) const override {
    double least = 0, most = 0, size = iso_;
    for (const std::uint32_t i : part) {
      const Ball& ball = pool_.balls[i];
      const CellRange square = square_in(ball, box);
      if (square.lo >= 1) continue;
      out.push_back(i);
      const double high = ball.strength * clamp_square(1 - square.lo);
      const double low = ball.strength * clamp_square(1 - square.hi);
      least += std::min(low, high), most += std::max(low, high);
      size += std::abs(ball.strength);
    }
    const double error = 0x1p-36 * size;
    return {iso_ - most - error, iso_ - least + error};
  }

  double least_size(std::span<const std::uint32_t> part) const override {
    double square = std::numeric_limits<double>::infinity();
    for (const std::uint32_t i : part) square = std::min(square, pool_.balls[i].square);
    return kLeastBallSize * std::sqrt(square);
  }

  double cost(std::span<const std::uint32_t> part) const override {
    double cost = kBallCellCost;
    for (const std::uint32_t i : part) cost += pool_.balls[i].form == Ball::kSphere ? kBallCost : kFormCost;
    return cost;
  }

 private:
  /// What a^2 / r^2 may be in a box.
  CellRange square_in(const Ball& ball, const CellBox& box) const {
    double near = 0, far = 0;
    if (ball.form == Ball::kSphere) {
      for (int k = 0; k < 3; ++k) {
        const double below = box.lo[k] - ball.center[k], above = ball.center[k] - box.hi[k];
        near += clamp_square(std::max(below, above));
        far += std::max(below * below, above * above);
      }
      return {near * ball.inverse_square, far * ball.inverse_square};
    }
    const BallForm& form = pool_.forms[ball.form];
    const Vec3d middle = (box.lo + box.hi) * 0.5 - ball.center, half = (box.hi - box.lo) * 0.5;
    Vec3d y, reach;
    for (int k = 0; k < 3; ++k) y[k] = dot(form.row[k], middle), reach[k] = dot(abs(form.row[k]), half);
    if (form.inverse_axis == 0) {
      for (int k = 0; k < 3; ++k) {
        const double from = std::abs(y[k]) - reach[k], to = std::abs(y[k]) + reach[k];
        near += clamp_square(from), far += to * to;
      }
    } else {
      // Distances do not grow faster than the way.
      const double along = std::clamp(dot(y, form.axis) * form.inverse_axis, 0.0, 1.0);
      const double away = length(y - form.axis * along), way = length(reach);
      near = clamp_square(away - way), far = (away + way) * (away + way);
    }
    return {near * (1 - kRounding), far * (1 + kRounding)};
  }
  static constexpr double kRounding = 0x1p-40;

  const MetaballsPool& pool_;
  double iso_;
};

bool matters(const MetaBall& b) { return b.radius > 0 && b.strength != 0; }
bool matters(const FieldElement& e) { return e.potential.scale > 0 && e.potential.weight != 0; }

bool is_sound(const MetaBall& b) {
  return std::isfinite(dot(b.center, b.center)) && std::isfinite(b.radius) && std::isfinite(b.strength);
}
/// Polygons and other potentials are for blob trees.
bool is_sound(const FieldElement& e) {
  const Potential& p = e.potential;
  if (p.kind != PotentialKind::wyvill || std::holds_alternative<PolygonSkeleton>(e.skeleton)) return false;
  const auto* const egg = std::get_if<EllipsoidSkeleton>(&e.skeleton);
  if (egg != nullptr && !(std::min({egg->radii.x, egg->radii.y, egg->radii.z}) > 0)) return false;
  const CellBox box = field::box_of(e.skeleton, 1);
  return std::isfinite(dot(box.lo, box.lo) + dot(box.hi, box.hi)) && std::isfinite(p.scale) &&
         std::isfinite(p.weight);
}

double alone(double iso, double strength) { return strength >= iso ? std::sqrt(iso / strength) : kInfinity; }

/// The element in the own space, which is about `middle` and in units of `size`.
void add_ball(MetaballsPool& pool, double iso, const FieldElement& e, const Vec3d& middle, double size) {
  std::vector<double> no_corners;
  const FieldPart part = field::make_part(e, middle, size, no_corners);
  BallForm form{{part.row[0], part.row[1], part.row[2]}, {0, 0, 0}, 0};
  if (part.shape == FieldPart::Shape::segment) {
    const double unit = std::sqrt(part.unit_square);
    for (int k = 0; k < 3; ++k) form.row[k] = {0, 0, 0}, form.row[k][k] = unit;
    form.axis = part.axis * unit;
    const double square = dot(form.axis, form.axis);
    form.inverse_axis = square > 0 ? 1 / square : 0;
    // Shorter than can be told from a point.
    if (!std::isfinite(form.inverse_axis)) form.inverse_axis = 0;
    if (form.inverse_axis == 0) form.axis = {0, 0, 0};
  }
  const double weight = part.weight, square = part.reach * part.reach;
  pool.balls.push_back({part.origin, square, 1 / square, weight, alone(iso, weight),
                        static_cast<std::uint32_t>(pool.forms.size())});
  pool.forms.push_back(form);
}

/// The box of what is positive; nothing if there is none, or something is not as it must be.
std::optional<CellBox> box_of(const MetaballsShape& s) {
  CellBox all{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  const auto grow = [&](const CellBox& box) { all = {min(all.lo, box.lo), max(all.hi, box.hi)}; };
  bool any = false;
  for (const MetaBall& b : s.balls) {
    if (!is_sound(b)) return std::nullopt;
    if (!matters(b) || b.strength < 0) continue;
    const Vec3d r{b.radius, b.radius, b.radius};
    grow({b.center - r, b.center + r}), any = true;
  }
  for (const FieldElement& e : s.elements) {
    if (!is_sound(e)) return std::nullopt;
    if (!matters(e) || e.potential.weight < 0) continue;
    grow(field::box_of(e.skeleton, e.potential.scale * (1 + 0x1p-30))), any = true;
  }
  return any ? std::optional(all) : std::nullopt;
}

/// The least of all radii, of negative balls, too.
double least_radius(const MetaballsShape& s) {
  double least = kInfinity;
  for (const MetaBall& b : s.balls)
    if (matters(b)) least = std::min(least, b.radius);
  for (const FieldElement& e : s.elements) {
    if (!matters(e)) continue;
    const auto* const egg = std::get_if<EllipsoidSkeleton>(&e.skeleton);
    const double narrow = egg != nullptr ? std::min({egg->radii.x, egg->radii.y, egg->radii.z}) : 1;
    least = std::min(least, e.potential.scale * narrow);
  }
  return least;
}

}  // namespace

void Metaballs::add(Pool& pool, const MetaballsShape& s, const ExactPlace& place) {
  const std::optional<CellBox> box = box_of(s);
  if (!box || !(s.iso > 0 && std::isfinite(s.iso))) return;
  const Vec3d lo = box->lo, middle = lo + (box->hi - lo) * 0.5, extent = box->hi - lo;
  const double size = 0.5 * std::max({extent.x, extent.y, extent.z});
  if (!(size > 0 && std::isfinite(dot(extent, extent)))) return;
  MetaballsElement e{s.iso, std::max(0x1p-32 * least_radius(s) / size, 0x1p-48),
                     static_cast<std::uint32_t>(pool.balls.size()), 0, 0};
  for (const MetaBall& b : s.balls) {
    if (!matters(b)) continue;
    const double r = b.radius / size;
    pool.balls.push_back(
        {(b.center - middle) / size, r * r, 1 / (r * r), b.strength, alone(s.iso, b.strength)});
  }
  for (const FieldElement& element : s.elements)
    if (matters(element)) add_ball(pool, s.iso, element, middle, size);
  e.count = static_cast<std::uint32_t>(pool.balls.size()) - e.begin;
  std::vector<std::uint32_t> all(e.count);
  std::iota(all.begin(), all.end(), e.begin);
  BallRule rule(pool, s.iso);
  const Vec3d half = extent * (0.5 / size);
  const auto element = static_cast<std::uint32_t>(pool.elements.size());
  e.root = pool.tree.divide(rule, {-half, half}, all, element, pool.cells);
  add_element(pool, e, place.to_world * Affine::translation(middle) * Affine::scaling({size, size, size}),
              place);
}

}  // namespace oktett
