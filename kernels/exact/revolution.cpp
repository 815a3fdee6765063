#include "kernels/exact/revolution.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/exact/cubic.h"
#include "kernels/exact/outline.h"
#include "kernels/exact/surface_uv.h"

namespace oktett {
namespace {

using Profile = RevolutionShape::Profile;

/// Whether the points from the first to the last are on the surface.
bool all_on_surface(const RevolutionShape& s) { return s.profile == Profile::linear; }

/// The radius, or its square, from point i to the next, in powers of v from -1 to 1. Slopes at points are
/// those of the chord from the point before to the point after.
void piece_powers(const RevolutionShape& s, std::size_t i, double (&c)[4]) {
  const ProfilePoint &p = s.points[i], &q = s.points[i + 1];
  if (s.profile == Profile::linear) {
    c[0] = 0.5 * (p.radius + q.radius), c[1] = 0.5 * (q.radius - p.radius), c[2] = c[3] = 0;
    return;
  }
  const double half = 0.5 * (q.height - p.height);
  const auto slope = [&](std::size_t k) {
    const ProfilePoint &before = s.points[k - 1], &after = s.points[k + 1];
    return (after.radius - before.radius) / (after.height - before.height);
  };
  double f0 = p.radius, f1 = q.radius, d0 = slope(i) * half, d1 = slope(i + 1) * half;
  if (s.profile == Profile::sor) d0 *= 2 * f0, d1 *= 2 * f1, f0 *= f0, f1 *= f1;
  // Hermite's form; that of Bezier has the control points f0 + 2/3 d0 and f1 - 2/3 d1.
  c[0] = 0.5 * (f0 + f1) - 0.25 * (d1 - d0);
  c[1] = 0.75 * (f1 - f0) - 0.25 * (d0 + d1);
  c[2] = 0.25 * (d1 - d0);
  c[3] = 0.25 * (d0 + d1) - 0.25 * (f1 - f0);
}

int piece_degree(const RevolutionShape& s) { return s.profile == Profile::linear ? 1 : 3; }

/// The points that the pieces lie between: from `begin` to `end`.
struct Span {
  std::size_t begin, end;
};
Span surface_points(const RevolutionShape& s) {
  const std::size_t n = s.points.size(), skip = all_on_surface(s) ? 0 : 1;
  return n < 2 + 2 * skip ? Span{0, 0} : Span{skip, n - skip};
}

}  // namespace

std::optional<double> profile_crosses_axis(const RevolutionShape& s) {
  const Span span = surface_points(s);
  double greatest = 0;
  for (std::size_t i = span.begin; i < span.end; ++i)
    greatest = std::max(greatest, std::abs(s.points[i].radius));
  if (s.profile == Profile::sor) greatest *= greatest;
  for (std::size_t i = span.begin; i + 1 < span.end; ++i) {
    double c[4], least = 0, at = 0;
    piece_powers(s, i, c);
    for_extremes(c, [&](double v, double f) {
      // What touches the axis may be rounded to the other side.
      if (f < -0x1p-40 * greatest && f < least) least = f, at = v;
    });
    if (least < 0) {
      const double y0 = s.points[i].height, y1 = s.points[i + 1].height;
      return 0.5 * (y0 + y1) + at * 0.5 * (y1 - y0);
    }
  }
  return std::nullopt;
}

void Revolution::add(Pool& pool, const RevolutionShape& described, const ExactPlace& place) {
  const Span span = surface_points(described);
  if (span.begin == span.end) return;
  // Own space: heights about the middle, everything about 1 in size.
  const double y0 = described.points[span.begin].height, y1 = described.points[span.end - 1].height;
  const double middle = 0.5 * (y0 + y1);
  double size = 0.5 * (y1 - y0);
  for (std::size_t i = span.begin; i < span.end; ++i) size = std::max(size, described.points[i].radius);
  if (!(size > 0 && y1 > y0 && std::isfinite(size + std::abs(middle)))) return;
  RevolutionShape s = described;
  for (ProfilePoint& p : s.points) p.radius /= size, p.height = (p.height - middle) / size;

  RevolutionElement e;
  e.degree = piece_degree(s);
  e.squared = s.profile == Profile::sor;
  e.closed = !s.open || (s.points[span.begin].radius == 0 && s.points[span.end - 1].radius == 0);
  for (std::size_t i = span.begin; i + 1 < span.end; ++i) {
    const ProfilePoint &p = s.points[i], &q = s.points[i + 1];
    if (!(p.height < q.height)) continue;
    RevolutionElement::Piece piece{};
    piece_powers(s, i, piece.c);
    piece.middle = 0.5 * (p.height + q.height);
    piece.per_half = 2 / (q.height - p.height);
    if (!std::isfinite(piece.per_half)) return;
    piece.ends[0] = {p.height, p.radius * p.radius, 0, false, 0};
    piece.ends[1] = {q.height, q.radius * q.radius, 0, false, 0};
    double greatest = 0;
    for_extremes(piece.c, [&](double, double f) { greatest = std::max(greatest, f); });
    piece.greatest2 = (e.squared ? greatest : greatest * greatest) * (1 + 0x1p-20) + 0x1p-80;
    e.pieces.push_back(piece);
  }
  if (e.pieces.empty()) return;
  for (std::size_t k = 0; k <= e.pieces.size(); ++k) {
    RevolutionElement::End* const below = k > 0 ? &e.pieces[k - 1].ends[1] : nullptr;
    RevolutionElement::End* const above = k < e.pieces.size() ? &e.pieces[k].ends[0] : nullptr;
    const int part = 1 + 2 * static_cast<int>(k);
    if (below) below->beyond2 = above ? above->here2 : 0, below->part = part;
    if (above) above->beyond2 = below ? below->here2 : 0, above->part = part;
    // Radii that change at one height make a ring, which belongs to the piece that reaches farther.
    if (below && above)
      below->listed = below->here2 > above->here2, above->listed = above->here2 > below->here2;
    else
      (below ? below : above)->listed = !s.open;
  }
  const Affine own = Affine::translation({0, middle, 0}) * Affine::scaling({size, size, size});
  for (std::size_t k = 0; k < e.pieces.size(); ++k) {
    if (k == 0) add_element(pool, e, place.to_world * own, place);
    const RevolutionElement::Piece& piece = e.pieces[k];
    const double r = std::sqrt(piece.greatest2);
    add_cell(pool, {-r, piece.ends[0].height, -r}, {r, piece.ends[1].height, r}).begin =
        static_cast<std::uint32_t>(k);
  }
}

bool Revolution::inside(const Pool& pool, std::size_t i, const Vec3d& p) {
  const RevolutionElement& e = pool.elements[i];
  if (!(e.pieces.front().ends[0].height <= p.y && p.y <= e.pieces.back().ends[1].height)) return false;
  return slope_at<Revolution>(pool, i, 0, p).value < 0;
}

SurfaceUv Revolution::uv(const Pool& pool, std::size_t i, int, const Vec3d& p) {
  const RevolutionElement& e = pool.elements[i];
  const double lo = e.pieces.front().ends[0].height, hi = e.pieces.back().ends[1].height;
  return {turn_around_y(p), (component(p, 1) - lo) / (hi - lo)};
}

namespace {

using Piece = RevolutionElement::Piece;

/// The nearest point of a piece whose c is the radius: a Bezier curve in the half-plane.
void keep_radius_piece(const Piece& piece, int degree, const HalfPlanePoint& p, HalfPlaneNearest& best) {
  const double y0 = piece.ends[0].height, y1 = piece.ends[1].height;
  if (degree == 1) return keep_segment(p, {cubic(piece.c, -1), y0}, {cubic(piece.c, 1), y1}, best);
  double r[4];
  bezier_of(piece.c, r);
  const OutlinePiece curve{
      {{r[0], y0}, {r[1], (2 * y0 + y1) / 3}, {r[2], (y0 + 2 * y1) / 3}, {r[3], y1}}, 3, 0, 0};
  const double s = curve.nearest({p.rho, p.z});
  const FlatPoint at = curve.at(s).at, right = curve.right(s);
  keep_nearer(p, {at.x, at.z}, {right.x, right.z}, best);
}

/// The nearest point of a piece whose c is the squared radius f. The squared distance from (rho, z) is
/// rho^2 - 2 rho sqrt(f) + q, where q = f + (y - z)^2. Its slope is zero where q' sqrt(f) = rho f', so that
/// q'^2 f = rho^2 f'^2, of degree 7. The piece is cut where q' or f' is zero: there roots of the square with
/// the other sign meet those that count.
class SquaredPiece {
 public:
  SquaredPiece(const Piece& piece, const HalfPlanePoint& p) : piece_(piece), p_(p) {
    const double(&c)[4] = piece.c;
    step_ = 1 / piece.per_half;
    const double f1[3] = {c[1], 2 * c[2], 3 * c[3]};
    const double q1[3] = {f1[0] + 2 * step_ * (piece.middle - p.z), f1[1] + 2 * step_ * step_, f1[2]};
    double f1f1[5] = {}, q1q1[5] = {};
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) f1f1[i + k] += f1[i] * f1[k], q1q1[i + k] += q1[i] * q1[k];
    for (int i = 0; i < 5; ++i) {
      slope_[i] -= p.rho * p.rho * f1f1[i];
      for (int k = 0; k < 4; ++k) slope_[i + k] += q1q1[i] * c[k];
    }
    cut(f1), cut(q1);
  }

  void keep(HalfPlaneNearest& best) const {
    for (int k = 0; k < count_; ++k) {
      keep_at(ends_[k], best);
      if (k + 1 == count_ || !(ends_[k] < ends_[k + 1])) continue;
      const double half = 0.5 * (ends_[k + 1] - ends_[k]), middle = ends_[k] + half;
      double c[8];
      std::copy_n(slope_, 8, c);
      // In powers of s, v = middle + half s.
      for (int i = 0; i < 7; ++i)
        for (int j = 6; j >= i; --j) c[j] += middle * c[j + 1];
      double power = 1;
      for (int i = 1; i < 8; ++i) power *= half, c[i] *= power;
      SignChanges turns;
      find_sign_changes(c, 7, roots::Method::automatic, kMaxRayDegree, turns);
      for (int i = 0; i < turns.count; ++i) keep_at(middle + half * turns.s[i], best);
    }
  }

 private:
  /// Divides where a quadratic is zero.
  void cut(const double (&c)[3]) {
    const double d = c[1] * c[1] - 4 * c[2] * c[0];
    if (!(d >= 0)) return;
    const double q = -0.5 * (c[1] + std::copysign(std::sqrt(d), c[1]));
    for (const double v : {q / c[2], c[0] / q})
      if (v > -1 && v < 1) {
        int i = count_++;
        for (; i > 0 && ends_[i - 1] > v; --i) ends_[i] = ends_[i - 1];
        ends_[i] = v;
      }
  }

  void keep_at(double v, HalfPlaneNearest& best) const {
    // The ends are those of the pieces beside it.
    const RevolutionElement::End* const end = v == -1 ? &piece_.ends[0] : v == 1 ? &piece_.ends[1] : nullptr;
    const double r = std::sqrt(end != nullptr ? end->here2 : std::max(cubic(piece_.c, v), 0.0));
    const double y = end != nullptr ? end->height : piece_.middle + step_ * v;
    const double slope = (3 * piece_.c[3] * v + 2 * piece_.c[2]) * v + piece_.c[1];
    // Along the curve the squared radius grows by `slope` as the height does by a step.
    const HalfPlanePoint normal{2 * r * step_, -slope};
    const double size = std::hypot(normal.rho, normal.z);
    keep_nearer(p_, {r, y},
                size > 0 ? HalfPlanePoint{normal.rho / size, normal.z / size} : HalfPlanePoint{1, 0}, best);
  }

  const Piece& piece_;
  HalfPlanePoint p_;
  double step_;
  double slope_[8] = {};
  double ends_[6] = {-1, 1};  ///< in ascending order
  int count_ = 2;
};

}  // namespace

bool Revolution::is_kept_by(const Affine& to_world) { return RoundFrame(to_world, 1).is_similar(); }

SurfaceNearest Revolution::closest(const Pool& pool, std::size_t i, const Affine& to_world, const Vec3d& p) {
  const RevolutionElement& e = pool.elements[i];
  RoundFrame frame(to_world, 1);
  const HalfPlanePoint far = frame.in_profile(p),
                       at{far.rho / frame.radial_scale(), far.z / frame.radial_scale()};
  HalfPlaneNearest best{std::numeric_limits<double>::infinity(), {}, {}};
  for (const Piece& piece : e.pieces) {
    if (e.squared)
      SquaredPiece(piece, at).keep(best);
    else
      keep_radius_piece(piece, e.degree, at, best);
    for (int k = 0; k < 2; ++k) {
      const RevolutionElement::End& end = piece.ends[k];
      if (!end.listed) continue;
      const HalfPlanePoint here{std::sqrt(end.here2), end.height}, beyond{std::sqrt(end.beyond2), end.height};
      k == 0 ? keep_segment(at, beyond, here, best) : keep_segment(at, here, beyond, best);
    }
  }
  SurfaceNearest nearest = frame.scaled_in_world(best);
  if (e.closed) nearest.tell_side(p, inside(pool, i, to_world.inverse().point(p)));
  return nearest;
}

}  // namespace oktett
