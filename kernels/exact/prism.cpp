#include "kernels/exact/prism.h"

#include <algorithm>
#include <cmath>

#include "kernels/exact/quadratic.h"
#include "kernels/exact/round_profile.h"

namespace oktett {
namespace {

using One = Simd<double, 1, ScalarIsa>;

double difference(double a, double b, double c, double d) {
  return only_lane(product_difference(One(a), One(b), One(c), One(d)));
}

/// Where roots are gathered, so that nothing is allocated ray by ray.
std::vector<OutlineRoot>& root_list() {
  thread_local std::vector<OutlineRoot> roots;
  return roots;
}

}  // namespace

std::size_t PrismPool::bytes() const {
  std::size_t sum = ExactPool<PrismElement>::bytes();
  for (const PrismElement& e : elements) sum += e.outlines.bytes();
  return sum;
}

void Prism::add(Pool& pool, const PrismShape& s, const ExactPlace& place) {
  const bool conic = s.sweep == PrismShape::Sweep::conic;
  const double from = std::min(s.from, s.to), to = std::max(s.from, s.to);
  if (!(from < to) || !std::isfinite(from) || !std::isfinite(to)) return;
  FlatPoint lo{kInfinity, kInfinity}, hi{-kInfinity, -kInfinity};
  for (const PlaneOutline& outline : s.outlines)
    for (const auto& piece : outline_pieces(outline, s.curve, 0))
      for (const FlatPoint& p : piece.p) {
        lo = {std::min(lo.x, p.x), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.z, p.z)};
      }
  if (!(lo.x < hi.x && lo.z < hi.z)) return;
  // Own space: about 1 in size and about the middle; one with a tip keeps that at the origin, and its
  // outlines their coordinates.
  const double highest = std::max(std::abs(from), std::abs(to));
  const double width =
      conic ? highest * std::max({std::abs(lo.x), std::abs(hi.x), std::abs(lo.z), std::abs(hi.z)})
            : 0.5 * std::max(hi.x - lo.x, hi.z - lo.z);
  const double size = std::max(width, conic ? highest : 0.5 * (to - from));
  Vec3d middle{0, 0, 0};
  if (!conic) middle = {0.5 * (lo.x + hi.x), 0.5 * (from + to), 0.5 * (lo.z + hi.z)};
  if (!std::isfinite(size + length(middle))) return;
  std::vector<std::vector<OutlinePiece>> outlines;
  for (PlaneOutline points : s.outlines) {
    if (!conic)
      for (FlatPoint& p : points) p = {(p.x - middle.x) / size, (p.z - middle.z) / size};
    outlines.push_back(outline_pieces(points, s.curve, 0x1p-48 * (conic ? width / highest : 1)));
  }
  PrismElement e{OutlineSet(outlines), (from - middle.y) / size, (to - middle.y) / size, conic, s.open};
  if (e.outlines.groups().empty() || !(e.from < e.to)) return;
  Affine own = Affine::translation(middle) * Affine::scaling({size, size, size});
  // From [x, height, z] to the axes of the description; the outlines' coordinates keep their order.
  if (s.axis == PrismShape::Axis::x) std::swap(own.m[0], own.m[1]);
  if (s.axis == PrismShape::Axis::z) std::swap(own.m[1], own.m[2]);
  add_element(pool, e, place.to_world * own, place);
  for (const OutlineSet::Group& group : e.outlines.groups()) {
    const auto reach = [&](double a, double b) {
      if (!conic) return std::pair{a, b};
      return std::pair{std::min({a * e.from, a * e.to, b * e.from, b * e.to}),
                       std::max({a * e.from, a * e.to, b * e.from, b * e.to})};
    };
    const auto [x0, x1] = reach(group.lo.x, group.hi.x);
    const auto [z0, z1] = reach(group.lo.z, group.hi.z);
    const double pad = 0x1p-40;
    ExactCell& cell = add_cell(pool, {x0 - pad, e.from - pad, z0 - pad}, {x1 + pad, e.to + pad, z1 + pad});
    cell.begin = group.begin, cell.count = group.end;
  }
}

Prism::Seen::Seen(const PrismElement& e, const Vec3d& o, const Vec3d& d)
    : may_meet(true), e_(e), o_(o), d_(d), is_point_(false), roots_(root_list()) {
  roots_.clear();
  if (!e.conic) {
    square_ = d.x * d.x + d.z * d.z;
    if (square_ > 0) {
      shift_ = -((o.x * d.x + o.z * d.z) / square_);
      at_ = {o.x + shift_ * d.x, o.z + shift_ * d.z};
      line = {-d.z, d.x, difference(d.z, at_.x, d.x, at_.z)};
      return;
    }
    at_ = {o.x, o.z};
  } else {
    // What is seen at (x, z) is in the plane of the ray and the tip: (x, 1, z) . (d x o) = 0.
    line = {difference(d.y, o.z, d.z, o.y), difference(d.x, o.y, d.y, o.x), difference(d.z, o.x, d.x, o.z)};
    if (line.gx != 0 || line.gz != 0) return;
    // Through the tip, or in the plane of it that has no points.
    may_meet = d.y != 0;
    at_ = {d.x / d.y, d.z / d.y};
  }
  is_point_ = true;
  line = {0, 1, -at_.z};
}

void Prism::Seen::add(const std::uint32_t* numbers, int count) {
  e_.outlines.find_roots(line, {numbers, static_cast<std::size_t>(count)}, roots_);
}

double Prism::Seen::place_of(const FlatPoint& p) const {
  if (is_point_) return p.x - at_.x;
  if (!e_.conic) return shift_ + ((p.x - at_.x) * d_.x + (p.z - at_.z) * d_.z) / square_;
  // Where o + t d is along q: the parts of o and d across q cancel. Their own digits are all that is lost.
  const auto across = [&](const Vec3d& v) {
    return Vec3d{difference(v.y, p.z, v.z, 1), difference(v.z, p.x, v.x, p.z), difference(v.x, 1, v.y, p.x)};
  };
  const Vec3d along = across(d_);
  return -(dot(across(o_), along) / dot(along, along));
}

int Prism::Seen::list(double begin, int room, Listed* out, double& up_to) {
  thread_local std::vector<Side> sides;
  sides.clear();
  for (const OutlineRoot& root : roots_) {
    const double t = place_of(e_.outlines.pieces()[root.piece].at(root.s).at);
    if (std::isfinite(t)) sides.push_back({t, root.piece, root.rises});
  }
  // Between the flat ends.
  double in = -kInfinity, exit = kInfinity;
  const bool level = d_.y == 0, up = d_.y > 0;
  if (level) {
    if (!(e_.from < o_.y && o_.y < e_.to)) return 0;
    if (e_.conic && o_.y == 0) return 0;
  } else {
    in = ((up ? e_.from : e_.to) - o_.y) / d_.y, exit = ((up ? e_.to : e_.from) - o_.y) / d_.y;
  }
  // Outside at the end of the line, which is where the ray is level with the tip.
  bool inside = false;
  if (is_point_) {
    for (const Side& side : sides) inside ^= side.t < 0;
    sides.clear();
  } else if (e_.conic && !level) {
    const double t = (0 - o_.y) / d_.y;
    for (const Side& side : sides) inside ^= side.t < t;
  }
  int count = 0;
  bool full = false;
  const auto push = [&](double t, double part) {
    if (t < begin || full) return;
    if (count == room) {
      // What is as far as the first one that has no room must come with it.
      full = true;
      const int before = count;
      while (count > 0 && out[count - 1].t == t) --count;
      if (count == 0) count = before;
      up_to = t;
      return;
    }
    out[count++] = {t, inside ? -1.0 : 1.0, part};
  };
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.t != b.t ? a.t < b.t : a.piece < b.piece; });
  std::size_t k = 0;
  for (; k < sides.size() && sides[k].t < in; ++k) inside = !inside;
  if (inside && !level && !e_.open) push(in, up ? 0 : 1);
  for (; k < sides.size() && sides[k].t <= exit && !full; ++k) {
    inside = !inside;
    // g rises along a piece where the ray passes it from left to right.
    const bool out_is_right = inside != sides[k].rises;
    push(sides[k].t, 2.0 + 2.0 * sides[k].piece + (out_is_right ? 1 : 0));
  }
  if (inside && !level && !e_.open && !full) {
    inside = false;
    push(exit, up ? 1 : 0);
  }
  return count;
}

Slope Prism::slope_at(const Pool& pool, std::size_t i, int part, const Vec3d& p) {
  const PrismElement& e = pool.elements[i];
  if (part < 2) return part == 0 ? Slope{e.from - p.y, {0, -1, 0}} : Slope{p.y - e.to, {0, 1, 0}};
  const OutlinePiece& piece = e.outlines.pieces()[static_cast<std::size_t>(part - 2) / 2];
  const double side = part % 2 == 1 ? 1 : -1;
  const FlatPoint q = e.conic ? FlatPoint{p.x / p.y, p.z / p.y} : FlatPoint{p.x, p.z};
  if (!std::isfinite(q.x + q.z)) return {0, {0, 0, 0}};
  const double s = piece.nearest(q);
  const FlatPoint at = piece.at(s).at, right = piece.right(s);
  const FlatPoint n{side * right.x, side * right.z};
  const double value = (q.x - at.x) * n.x + (q.z - at.z) * n.z;
  if (!e.conic) return {value, {n.x, 0, n.z}};
  // |y| times the value in the plane.
  const double sign = p.y < 0 ? -1 : 1;
  return {std::abs(p.y) * value, {sign * n.x, sign * (value - q.x * n.x - q.z * n.z), sign * n.z}};
}

bool Prism::inside(const Pool& pool, std::size_t i, const Vec3d& p) {
  const PrismElement& e = pool.elements[i];
  if (!(e.from < p.y && p.y < e.to)) return false;
  if (!e.conic) return e.outlines.inside({p.x, p.z});
  return p.y != 0 && e.outlines.inside({p.x / p.y, p.z / p.y});
}

SurfaceUv Prism::uv(const Pool& pool, std::size_t i, int part, const Vec3d& p) {
  const PrismElement& e = pool.elements[i];
  if (part < 2) {
    const double height = e.conic ? (part == 0 ? e.from : e.to) : 1;
    const FlatPoint a = e.outlines.lo(), b = e.outlines.hi();
    const auto across = [&](int axis, double lo, double hi) {
      return (component(p, axis) - height * lo) / (height * (hi - lo));
    };
    return {across(0, a.x, b.x), across(2, a.z, b.z)};
  }
  const OutlinePiece& piece = e.outlines.pieces()[static_cast<std::size_t>(part - 2) / 2];
  const FlatPoint q = e.conic ? FlatPoint{p.x / p.y, p.z / p.y} : FlatPoint{p.x, p.z};
  const double s = piece.nearest(q);
  // A step along the piece, which is its derivative times that of s, changes s by as much.
  const FlatPoint t = piece.at(s).slope;
  const double per = piece.per_one / (t.x * t.x + t.z * t.z);
  Vec3d along{t.x * per, 0, t.z * per};
  if (e.conic) along = Vec3d{along.x, -(q.x * along.x + q.z * along.z), along.z} * (1 / p.y);
  return {{piece.begin + s * piece.per_one, along}, (component(p, 1) - e.from) / (e.to - e.from)};
}

bool Prism::is_kept_by(const Affine& to_world) { return RoundFrame(to_world).is_similar(); }

namespace {

/// The point of the line between a and b that is nearest to p.
Vec3d nearest_between(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d along = b - a;
  const double square = dot(along, along);
  return square > 0 ? a + along * std::clamp(dot(p - a, along) / square, 0.0, 1.0) : a;
}

/// The nearest point of the side over one piece of a prism with a tip.
class ConicSide {
 public:
  ConicSide(const PrismElement& e, const OutlinePiece& piece, const Vec3d& p) : e_(e), piece_(piece), p_(p) {
    // No point of the side moves faster than this with s.
    for (int k = 0; k < piece.degree; ++k)
      speed_ = std::max(speed_, std::hypot(piece.p[k + 1].x - piece.p[k].x, piece.p[k + 1].z - piece.p[k].z));
    speed_ *= piece.degree * std::max(std::abs(e.from), std::abs(e.to));
  }
  /// Looks where something nearer than `best` may be.
  void find(double& best, double& s) const { search(0, 1, 0, best, s); }
  Vec3d point(double s) const {
    const FlatPoint q = piece_.at(s).at;
    const Vec3d ray{q.x, 1, q.z};
    return nearest_between(p_, ray * e_.from, ray * e_.to);
  }

 private:
  double distance(double s) const { return length(point(s) - p_); }
  void search(double lo, double hi, int depth, double& best, double& s) const {
    const double middle = 0.5 * (lo + hi), here = distance(middle);
    if (here < best) best = here, s = middle;
    if (here - speed_ * 0.5 * (hi - lo) > best) return;
    constexpr int kHalvings = 8;
    if (depth < kHalvings) {
      search(lo, middle, depth + 1, best, s);
      return search(middle, hi, depth + 1, best, s);
    }
    // By the golden section.
    constexpr double kGolden = 0.6180339887498949;
    double a = lo, b = hi, c = b - kGolden * (b - a), d = a + kGolden * (b - a);
    double at_c = distance(c), at_d = distance(d);
    for (int i = 0; i < 60 && a < b; ++i) {
      if (at_c < at_d)
        b = d, d = c, at_d = at_c, c = b - kGolden * (b - a), at_c = distance(c);
      else
        a = c, c = d, at_c = at_d, d = a + kGolden * (b - a), at_d = distance(d);
    }
    for (const double x : {lo, a, b, hi})
      if (const double away = distance(x); away < best) best = away, s = x;
  }

  const PrismElement& e_;
  const OutlinePiece& piece_;
  const Vec3d& p_;
  double speed_ = 0;
};

}  // namespace

SurfaceNearest Prism::closest(const Pool& pool, std::size_t i, const Affine& to_world, const Vec3d& world) {
  const PrismElement& e = pool.elements[i];
  const Affine to_own = to_world.inverse();
  const Vec3d p = to_own.point(world);
  SurfaceNearest best;
  const bool within = !e.open && inside(pool, i, p);
  const auto keep = [&](const Vec3d& at, const Vec3d& normal) {
    const Vec3d there = to_world.point(at), away = world - there;
    SurfaceNearest found{dot(away, away), there, normalize(to_own.normal_by_inverse(normal))};
    if (!e.open) found.tell_side(world, within);
    best.keep_nearer(world, found);
  };
  if (!e.open) {
    for (int end = 0; end < 2; ++end) {
      const double y = end == 0 ? e.from : e.to;
      const Vec3d up{0, end == 0 ? -1.0 : 1.0, 0};
      const double scale = e.conic ? y : 1;
      if (scale != 0 && e.outlines.inside({p.x / scale, p.z / scale})) keep({p.x, y, p.z}, up);
    }
  }
  const auto keep_side = [&](const OutlinePiece& piece, double s, const Vec3d& at) {
    const FlatPoint right = piece.right(s), q = piece.at(s).at;
    Vec3d n{right.x, e.conic ? -(q.x * right.x + q.z * right.z) : 0, right.z};
    // Which side of the piece is outside?
    const double step = 0x1p-24 * std::max({std::abs(q.x), std::abs(q.z), 1.0});
    const bool right_is_in = e.outlines.inside({q.x + step * right.x, q.z + step * right.z});
    if (right_is_in != (e.conic && at.y < 0)) n = -n;
    keep(at, n);
  };
  if (!e.conic) {
    const OutlineSet::Nearest nearest = e.outlines.nearest({p.x, p.z});
    const OutlinePiece& piece = e.outlines.pieces()[nearest.piece];
    const FlatPoint at = piece.at(nearest.s).at;
    keep_side(piece, nearest.s, {at.x, std::clamp(p.y, e.from, e.to), at.z});
    return best;
  }
  double least = kInfinity, s = 0;
  const OutlinePiece* piece = nullptr;
  for (const OutlinePiece& candidate : e.outlines.pieces()) {
    const double before = least;
    ConicSide(e, candidate, p).find(least, s);
    if (least < before) piece = &candidate;
  }
  if (piece != nullptr) keep_side(*piece, s, ConicSide(e, *piece, p).point(s));
  return best;
}

}  // namespace oktett
