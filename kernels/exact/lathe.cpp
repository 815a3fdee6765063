#include "kernels/exact/lathe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kernels/exact/cubic.h"
#include "kernels/exact/outline.h"
#include "kernels/exact/surface_uv.h"

namespace oktett {
namespace {

using Piece = LatheElement::Piece;

double cubic_slope(const double (&c)[4], double v) { return (3 * c[3] * v + 2 * c[2]) * v + c[1]; }
double cubic_curve(const double (&c)[4], double v) { return 6 * c[3] * v + 2 * c[2]; }

/// From Bezier's control points to powers of v = 2 u - 1. What rounding left of powers that are not there
/// becomes zero, so that straight pieces and parabolas are solved as such.
void powers(double p0, double p1, double p2, double p3, double (&c)[4]) {
  c[0] = (p0 + 3 * p1 + 3 * p2 + p3) / 8;
  c[1] = 3 * ((p3 - p0) + (p2 - p1)) / 8;
  c[2] = 3 * ((p0 - p1) + (p3 - p2)) / 8;
  c[3] = ((p3 - p0) - 3 * (p2 - p1)) / 8;
  const double rounding = 0x1p-50 * (std::abs(p0) + std::abs(p1) + std::abs(p2) + std::abs(p3));
  for (int i = 3; i > 1 && std::abs(c[i]) <= rounding; --i) c[i] = 0;
}

int degree_of(const double (&c)[4]) { return c[3] != 0 ? 3 : c[2] != 0 ? 2 : 1; }

struct CurveInterval {
  double lo, hi;
};
CurveInterval range_of(const double (&c)[4]) {
  CurveInterval i{HUGE_VAL, -HUGE_VAL};
  for_extremes(c, [&](double, double f) { i = {std::min(i.lo, f), std::max(i.hi, f)}; });
  return i;
}

std::vector<Piece> pieces_of(const std::vector<ProfilePoint>& p) {
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i + 3 < p.size(); i += 3) {
    Piece piece{};
    powers(p[i].radius, p[i + 1].radius, p[i + 2].radius, p[i + 3].radius, piece.r);
    powers(p[i].height, p[i + 1].height, p[i + 2].height, p[i + 3].height, piece.y);
    piece.degree = std::max(degree_of(piece.r), degree_of(piece.y));
    piece.radius[0] = p[i].radius, piece.radius[1] = p[i + 3].radius;
    piece.height[0] = p[i].height, piece.height[1] = p[i + 3].height;
    const CurveInterval y = range_of(piece.y);
    piece.least_y = y.lo, piece.greatest_y = y.hi, piece.most = range_of(piece.r).hi;
    pieces.push_back(piece);
  }
  return pieces;
}

/// Twice the area between the curve and the axis, positive if the curve runs from bottom to top.
double signed_area(const std::vector<Piece>& pieces) {
  double area = 0;
  constexpr int kSteps = 64;
  for (const Piece& p : pieces)
    for (int i = 0; i < kSteps; ++i) {
      const double u = -1 + 2.0 * i / kSteps, v = -1 + 2.0 * (i + 1) / kSteps;
      area += (cubic(p.r, u) + cubic(p.r, v)) * (cubic(p.y, v) - cubic(p.y, u));
    }
  return area;
}

/// The point of the curve nearest to (rho, y).
struct CurvePoint {
  std::size_t piece = 0;
  double v = 0, distance2 = HUGE_VAL;
};

/// The square of the distance of (rho, y) from the bounds of a piece.
double bounds_distance2(const Piece& p, double rho, double y) {
  const double dy = std::max({p.least_y - y, y - p.greatest_y, 0.0}), dr = std::max(rho - p.most, 0.0);
  return dy * dy + dr * dr;
}

/// Takes the nearest point of piece `k` if it is nearer, or as near and on an earlier piece.
void keep_nearest(const LatheElement& e, std::size_t k, double rho, double y, CurvePoint& best) {
  const Piece& p = e.pieces[k];
  // The distance from a straight piece has one minimum, which Newton's first step finds from anywhere.
  const bool straight = p.degree == 1;
  const int places = straight ? 1 : 8;
  const double longest = straight ? 2 : 0.25;
  double start = 0, least = HUGE_VAL;
  for (int i = 0; i <= places; ++i) {
    const double v = -1 + 2.0 * i / places, a = cubic(p.r, v) - rho, b = cubic(p.y, v) - y;
    if (a * a + b * b < least) least = a * a + b * b, start = v;
  }
  double v = start;
  for (int i = 0; i < 8; ++i) {
    const double a = cubic(p.r, v) - rho, b = cubic(p.y, v) - y;
    const double da = cubic_slope(p.r, v), db = cubic_slope(p.y, v);
    const double slope = a * da + b * db, speed = da * da + db * db;
    const double curve = speed + a * cubic_curve(p.r, v) + b * cubic_curve(p.y, v);
    const double step = slope / (curve > 0.25 * speed ? curve : speed);
    if (!std::isfinite(step)) break;
    const double before = v;
    v = std::clamp(v - std::clamp(step, -longest, longest), -1.0, 1.0);
    // The next step would be about the square of this one.
    if (v == before || std::abs(step) < 0x1p-30) break;
  }
  for (const double w : {start, v}) {
    const double a = cubic(p.r, w) - rho, b = cubic(p.y, w) - y, distance2 = a * a + b * b;
    if (distance2 < best.distance2 || (distance2 == best.distance2 && k < best.piece))
      best = {k, w, distance2};
  }
}

/// Begins with the piece whose bounds are nearest, so that most others need not be looked at.
CurvePoint nearest_point(const LatheElement& e, double rho, double y) {
  std::size_t first = 0;
  double least = HUGE_VAL;
  for (std::size_t k = 0; k < e.pieces.size(); ++k)
    if (const double d = bounds_distance2(e.pieces[k], rho, y); d < least) least = d, first = k;
  CurvePoint best;
  keep_nearest(e, first, rho, y, best);
  for (std::size_t k = 0; k < e.pieces.size(); ++k)
    if (k != first && bounds_distance2(e.pieces[k], rho, y) <= best.distance2)
      keep_nearest(e, k, rho, y, best);
  return best;
}

/// Outwards, in the half-plane.
struct Normal2 {
  double r, y;
};
Normal2 normal_at(const LatheElement& e, const CurvePoint& at) {
  const Piece& p = e.pieces[at.piece];
  const double dr = cubic_slope(p.r, at.v), dy = cubic_slope(p.y, at.v), l = std::sqrt(dr * dr + dy * dy);
  return l > 0 ? Normal2{e.side * dy / l, -e.side * dr / l} : Normal2{1, 0};
}

/// A sequence of roots whose number does not fit the signs at the ends has one too many or too few there.
void make_agree(SignChanges& found, double before, double after, double certainty_before,
                double certainty_after) {
  if ((found.count % 2 == 1) == (before != after)) {
    // In turn from what is before.
  } else if (found.count > 0 && found.s[0] < -1 + 0x1p-30) {
    for (int i = 1; i < found.count; ++i) found.s[i - 1] = found.s[i];
    --found.count;
  } else if (found.count > 0 && found.s[found.count - 1] > 1 - 0x1p-30) {
    --found.count;
  } else if (found.count < kMaxRayDegree) {
    const bool first = certainty_before < certainty_after;
    if (first)
      for (int i = found.count; i > 0; --i) found.s[i] = found.s[i - 1];
    found.s[first ? 0 : found.count] = first ? -1 : 1;
    ++found.count;
  }
  for (int i = 0; i < found.count; ++i) found.turn[i] = i % 2 == 0 ? -before : before;
}

double sign_of(double x) { return x < 0 ? -1 : 1; }

/// Where the piece is at the height y.
SignChanges places_at_height(const Piece& piece, double y) {
  const double c[4] = {piece.y[0] - y, piece.y[1], piece.y[2], piece.y[3]};
  SignChanges found;
  find_sign_changes(c, 3, roots::Method::automatic, kMaxRayDegree, found);
  const double before = piece.height[0] - y, after = piece.height[1] - y;
  make_agree(found, sign_of(before), sign_of(after), std::abs(before), std::abs(after));
  return found;
}

/// The t at which a line meets the circle of a piece at v, given that by its height. If the curve is steep
/// the radius is the better guide: then t is moved less by what v is off.
double place_on(const double (&line)[6], const Piece& piece, double v, double t) {
  const double ox = line[0], oz = line[2], dx = line[3], dz = line[5], dd = dx * dx + dz * dz;
  const double nearest = -(ox * dx + oz * dz) / dd, away = t - nearest, r = cubic(piece.r, v);
  const double per_height = std::abs(cubic_slope(piece.y, v) / line[4]);
  const double per_radius = std::abs(r * cubic_slope(piece.r, v) / (dd * away));
  if (!(per_radius < per_height)) return t;
  const double x = ox + nearest * dx, z = oz + nearest * dz;
  const double reach = std::sqrt(std::max(r * r - (x * x + z * z), 0.0) / dd);
  return nearest + (away < 0 ? -reach : reach);
}

}  // namespace

std::vector<ProfilePoint> curve_through(const std::vector<ProfilePoint>& p) {
  std::vector<ProfilePoint> out{p[1]};
  for (std::size_t i = 1; i + 2 < p.size(); ++i) {
    const ProfilePoint &a = p[i - 1], &b = p[i], &c = p[i + 1], &d = p[i + 2];
    out.push_back({b.radius + (c.radius - a.radius) / 6, b.height + (c.height - a.height) / 6});
    out.push_back({c.radius - (d.radius - b.radius) / 6, c.height - (d.height - b.height) / 6});
    out.push_back(c);
  }
  return out;
}

const char* why_bad_profile(const LatheShape& shape) {
  const std::vector<Piece> pieces = pieces_of(shape.points);
  double most = 0;
  for (const Piece& p : pieces) most = std::max(most, p.most);
  for (const Piece& p : pieces)
    if (range_of(p.r).lo < -0x1p-40 * most) return "the profile crosses the axis";
  // A chain of chords that crosses itself.
  constexpr int kSteps = 16;
  std::vector<std::array<double, 2>> chain;
  for (std::size_t k = 0; k < pieces.size(); ++k)
    for (int i = k == 0 ? 0 : 1; i <= kSteps; ++i) {
      const double v = -1 + 2.0 * i / kSteps;
      chain.push_back({cubic(pieces[k].r, v), cubic(pieces[k].y, v)});
    }
  const auto turn = [&](std::size_t a, std::size_t b, std::size_t c) {
    return (chain[b][0] - chain[a][0]) * (chain[c][1] - chain[a][1]) -
           (chain[b][1] - chain[a][1]) * (chain[c][0] - chain[a][0]);
  };
  for (std::size_t i = 0; i + 1 < chain.size(); ++i)
    for (std::size_t k = i + 2; k + 1 < chain.size(); ++k)
      if (turn(i, i + 1, k) * turn(i, i + 1, k + 1) < 0 && turn(k, k + 1, i) * turn(k, k + 1, i + 1) < 0)
        return "the profile crosses itself";
  return "";
}

void Lathe::add(Pool& pool, const LatheShape& s, const ExactPlace& place) {
  if (s.points.size() < 4 || s.points.size() % 3 != 1) return;
  double lo = HUGE_VAL, hi = -HUGE_VAL, most = 0;
  for (const Piece& p : pieces_of(s.points))
    lo = std::min(lo, p.least_y), hi = std::max(hi, p.greatest_y), most = std::max(most, p.most);
  const double middle = 0.5 * (lo + hi), size = std::max(most, 0.5 * (hi - lo));
  if (!(size > 0 && most > 0 && std::isfinite(size + std::abs(middle)))) return;
  std::vector<ProfilePoint> points = s.points;
  for (ProfilePoint& p : points) p.radius /= size, p.height = (p.height - middle) / size;
  LatheElement e;
  e.pieces = pieces_of(points);
  const double area = signed_area(e.pieces);
  if (area == 0) return;
  e.side = sign_of(area);
  const ProfilePoint &first = points.front(), &last = points.back();
  const bool loop = first.radius == last.radius && first.height == last.height;
  e.pieces.front().cap[0] = !s.open && !loop && first.radius > 0;
  e.pieces.back().cap[1] = !s.open && !loop && last.radius > 0;
  e.closed = !s.open || loop || (first.radius == 0 && last.radius == 0);
  const Affine own = Affine::translation({0, middle, 0}) * Affine::scaling({size, size, size});
  for (Piece& p : e.pieces) p.most = p.most * (1 + 0x1p-20) + 0x1p-40;
  add_element(pool, e, place.to_world * own, place);
  for (std::size_t k = 0; k < e.pieces.size(); ++k) {
    const Piece& p = e.pieces[k];
    const double pad = 0x1p-40;
    add_cell(pool, {-p.most, p.least_y - pad, -p.most}, {p.most, p.greatest_y + pad, p.most}).begin =
        static_cast<std::uint32_t>(k);
  }
}

void Lathe::Found::push(double place, double way, double of) {
  if (count == kMaxCrossings) return;
  int i = count++;
  for (; i > 0 && t[i - 1] > place; --i) t[i] = t[i - 1], turn[i] = turn[i - 1], part[i] = part[i - 1];
  t[i] = place, turn[i] = way, part[i] = of;
}

void Lathe::find(const LatheElement& e, const Piece& piece, const OneRay& ray, Found& out) {
  const double ox = ray.line[0], oy = ray.line[1], oz = ray.line[2];
  const double dx = ray.line[3], dy = ray.line[4], dz = ray.line[5];
  const double dd = dx * dx + dz * dz;
  if (std::abs(dy) <= kLevel * std::sqrt(dd)) return find_level(e, piece, ray, out);
  // Inside of the circles at the ends? This must be the same bits for the next piece.
  double t_end[2], excess[2], certainty[2];
  for (int k = 0; k < 2; ++k) {
    t_end[k] = (piece.height[k] - oy) / dy;
    const double x = ox + t_end[k] * dx, z = oz + t_end[k] * dz, r2 = piece.radius[k] * piece.radius[k];
    excess[k] = x * x + z * z - r2;
    certainty[k] = std::abs(excess[k]) / (x * x + z * z + r2);
    if (piece.cap[k] && excess[k] < 0 && t_end[k] >= ray.begin) {
      // The disk faces down at the beginning of a curve that runs upwards.
      const double up = k == 0 ? -e.side : e.side;
      out.push(t_end[k], sign_of(up * dy), 1 + k);
    }
  }
  if (std::abs(dy) <= kShallow * std::sqrt(dd)) return find_shallow(e, piece, ray, excess, out);
  if (!ray.on_surface && sign_of(excess[0]) == sign_of(excess[1])) return;
  SignChanges found;
  found.count = ray.count;
  std::copy_n(ray.changes, ray.count, found.s);
  make_agree(found, sign_of(excess[0]), sign_of(excess[1]), certainty[0], certainty[1]);
  for (int i = 0; i < found.count; ++i) {
    const double t = place_on(ray.line, piece, found.s[i], (cubic(piece.y, found.s[i]) - oy) / dy);
    if (t >= ray.begin) out.push(t, found.turn[i] * sign_of(dy) * e.side, 0);
  }
}

void Lathe::find_shallow(const LatheElement& e, const Piece& piece, const OneRay& ray,
                         const double (&excess)[2], Found& out) {
  const double(&l)[6] = ray.line;
  const double half = 0.5 * (ray.b - ray.a), middle = ray.a + half;
  const double m[3] = {l[0] + middle * l[3], l[1] + middle * l[4], l[2] + middle * l[5]};
  const double h[3] = {half * l[3], half * l[4], half * l[5]};
  if (h[1] == 0) return find_level(e, piece, ray, out);
  // The parts of the piece at heights that the ray has there.
  const double rise = std::abs(h[1]) * (1 + 0x1p-20) + 0x1p-50;
  double cuts[8] = {-1};
  int count = 1;
  for (int side = -1; side <= 1; side += 2) {
    const double c[4] = {piece.y[0] - (m[1] + side * rise), piece.y[1], piece.y[2], piece.y[3]};
    SignChanges found;
    find_sign_changes(c, 3, roots::Method::automatic, 3, found);
    for (int i = 0; i < found.count; ++i) cuts[count++] = found.s[i];
  }
  cuts[count++] = 1;
  for (int i = 1; i < count; ++i)
    for (int k = i; k > 0 && cuts[k] < cuts[k - 1]; --k) std::swap(cuts[k], cuts[k - 1]);
  for (int k = 0; k + 1 < count; ++k) {
    const double lo = cuts[k], hi = cuts[k + 1], v = 0.5 * (lo + hi), w = 0.5 * (hi - lo);
    if (!(lo < hi) || !(std::abs(cubic(piece.y, v) - m[1]) <= rise)) continue;
    // Powers of u, with v + w u; heights in terms of s.
    const auto local = [&](const double(&c)[4], double(&d)[4]) {
      d[0] = cubic(c, v), d[1] = w * cubic_slope(c, v), d[2] = w * w * (c[2] + 3 * c[3] * v),
      d[3] = w * w * w * c[3];
    };
    double y[4], r[4];
    local(piece.y, y), local(piece.r, r);
    y[0] -= m[1];
    for (double& f : y) f /= h[1];
    double c[7] = {};
    const double a = h[0] * h[0] + h[2] * h[2], b = m[0] * h[0] + m[2] * h[2];
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) c[i + j] += a * y[i] * y[j] - r[i] * r[j];
    for (int i = 0; i < 4; ++i) c[i] += 2 * b * y[i];
    c[0] += m[0] * m[0] + m[2] * m[2];
    double ends[2] = {0, 0};
    for (int i = 0; i < 7; ++i) ends[0] += i % 2 == 0 ? c[i] : -c[i], ends[1] += c[i];
    const double before = lo == -1 ? excess[0] : ends[0], after = hi == 1 ? excess[1] : ends[1];
    SignChanges found;
    find_sign_changes(c, 6, roots::Method::automatic, kMaxRayDegree, found);
    make_agree(found, sign_of(before), sign_of(after), std::abs(ends[0]), std::abs(ends[1]));
    for (int i = 0; i < found.count; ++i) {
      const double u = found.s[i], s = ((y[3] * u + y[2]) * u + y[1]) * u + y[0];
      const double t = place_on(l, piece, v + w * u, middle + s * half);
      if (t >= ray.begin) out.push(t, found.turn[i] * sign_of(l[4]) * e.side, 0);
    }
  }
}

void Lathe::find_level(const LatheElement& e, const Piece& piece, const OneRay& ray, Found& out) {
  const double ox = ray.line[0], oz = ray.line[2], dx = ray.line[3], dz = ray.line[5];
  const double dd = dx * dx + dz * dz, nearest = -(ox * dx + oz * dz) / dd;
  const double x = ox + nearest * dx, z = oz + nearest * dz, y = ray.line[1] + nearest * ray.line[4];
  const SignChanges found = places_at_height(piece, y);
  for (int i = 0; i < found.count; ++i) {
    const double r = cubic(piece.r, found.s[i]), room = r * r - (x * x + z * z);
    if (!(room > 0)) continue;
    const double reach = std::sqrt(room / dd);
    // found.turn is where y(v) goes, and the ray comes towards the axis first.
    const double way = found.turn[i] * e.side;
    if (nearest - reach >= ray.begin) out.push(nearest - reach, -way, 0);
    if (nearest + reach >= ray.begin) out.push(nearest + reach, way, 0);
  }
}

Slope Lathe::slope_at(const Pool& pool, std::size_t i, int part, const Vec3d& p) {
  const LatheElement& e = pool.elements[i];
  if (part == 1) return {-e.side * (p.y - e.pieces.front().height[0]), {0, -e.side, 0}};
  if (part == 2) return {e.side * (p.y - e.pieces.back().height[1]), {0, e.side, 0}};
  const double rho = std::sqrt(p.x * p.x + p.z * p.z);
  const CurvePoint at = nearest_point(e, rho, p.y);
  const Normal2 n = normal_at(e, at);
  const Piece& piece = e.pieces[at.piece];
  const double per_rho = rho > 0 ? n.r / rho : 0;
  return {(rho - cubic(piece.r, at.v)) * n.r + (p.y - cubic(piece.y, at.v)) * n.y,
          {p.x * per_rho, n.y, p.z * per_rho}};
}

bool Lathe::inside(const Pool& pool, std::size_t i, const Vec3d& p) {
  // A level line outwards crosses the curve an odd number of times.
  const LatheElement& e = pool.elements[i];
  const double rho = std::sqrt(p.x * p.x + p.z * p.z);
  bool odd = false;
  for (const Piece& piece : e.pieces) {
    if (p.y < piece.least_y || p.y > piece.greatest_y || rho > piece.most) continue;
    const SignChanges found = places_at_height(piece, p.y);
    for (int k = 0; k < found.count; ++k) odd ^= cubic(piece.r, found.s[k]) > rho;
  }
  return odd;
}

SurfaceUv Lathe::uv(const Pool& pool, std::size_t i, int, const Vec3d& p) {
  const LatheElement& e = pool.elements[i];
  const double rho = std::sqrt(p.x * p.x + p.z * p.z), pieces = static_cast<double>(e.pieces.size());
  const CurvePoint at = nearest_point(e, rho, p.y);
  // A step along the curve, which is its derivative times that of v, changes v by as much.
  const Piece& piece = e.pieces[at.piece];
  const double dr = cubic_slope(piece.r, at.v), dy = cubic_slope(piece.y, at.v);
  const double per_rho = rho > 0 ? dr / rho : 0;
  const Vec3d along{p.x * per_rho, dy, p.z * per_rho};
  const double v = (static_cast<double>(at.piece) + 0.5 * (at.v + 1)) / pieces;
  return {turn_around_y(p), {v, along * (0.5 / (pieces * (dr * dr + dy * dy)))}};
}

/// Not only a near point, as nearest_point() finds, but the nearest of the whole piece.
static void keep_piece(const Piece& piece, double side, const HalfPlanePoint& p, HalfPlaneNearest& best) {
  const FlatPoint first{piece.radius[0], piece.height[0]}, last{piece.radius[1], piece.height[1]};
  OutlinePiece curve{{first, last, last, last}, piece.degree, 0, 0};
  if (piece.degree == 2) curve.p[1] = {piece.r[0] - piece.r[2], piece.y[0] - piece.y[2]};
  if (piece.degree == 3) {
    double r[4], y[4];
    bezier_of(piece.r, r), bezier_of(piece.y, y);
    curve.p[1] = {r[1], y[1]}, curve.p[2] = {r[2], y[2]};
  }
  const double s = curve.nearest({p.rho, p.z});
  const FlatPoint at = curve.at(s).at, right = curve.right(s);
  keep_nearer(p, {at.x, at.z}, {side * right.x, side * right.z}, best);
}

bool Lathe::is_kept_by(const Affine& to_world) { return RoundFrame(to_world, 1).is_similar(); }

SurfaceNearest Lathe::closest(const Pool& pool, std::size_t i, const Affine& to_world, const Vec3d& p) {
  const LatheElement& e = pool.elements[i];
  RoundFrame frame(to_world, 1);
  const double scale = frame.radial_scale();
  const HalfPlanePoint far = frame.in_profile(p), at{far.rho / scale, far.z / scale};
  HalfPlaneNearest best{std::numeric_limits<double>::infinity(), {}, {}};
  for (const Piece& piece : e.pieces) {
    if (bounds_distance2(piece, at.rho, at.z) <= best.d2 * (1 + 0x1p-40)) keep_piece(piece, e.side, at, best);
    for (int k = 0; k < 2; ++k) {
      if (!piece.cap[k]) continue;
      const HalfPlanePoint axis{0, piece.height[k]}, rim{piece.radius[k], piece.height[k]};
      (k == 0) == (e.side > 0) ? keep_segment(at, axis, rim, best) : keep_segment(at, rim, axis, best);
    }
  }
  SurfaceNearest nearest = frame.scaled_in_world(best);
  if (e.closed) nearest.tell_side(p, inside(pool, i, to_world.inverse().point(p)));
  return nearest;
}

}  // namespace oktett
