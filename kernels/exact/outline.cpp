#include "kernels/exact/outline.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "kernels/exact/ray_polynomial.h"

namespace oktett {
namespace {

using OutlineCurve = PrismShape::Curve;

FlatPoint operator+(const FlatPoint& a, const FlatPoint& b) { return {a.x + b.x, a.z + b.z}; }
FlatPoint operator-(const FlatPoint& a, const FlatPoint& b) { return {a.x - b.x, a.z - b.z}; }
FlatPoint operator*(const FlatPoint& a, double s) { return {a.x * s, a.z * s}; }
double dot(const FlatPoint& a, const FlatPoint& b) { return a.x * b.x + a.z * b.z; }
double size_of(const FlatPoint& a) { return std::max(std::abs(a.x), std::abs(a.z)); }

struct PlaneBox {
  FlatPoint lo{HUGE_VAL, HUGE_VAL}, hi{-HUGE_VAL, -HUGE_VAL};

  void grow(const FlatPoint& p) {
    lo = {std::min(lo.x, p.x), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.z, p.z)};
  }
  void grow(const OutlinePiece& piece) {
    for (const FlatPoint& p : piece.p) grow(p);
  }
  bool meets(const PlaneBox& b) const {
    return lo.x <= b.hi.x && b.lo.x <= hi.x && lo.z <= b.hi.z && b.lo.z <= hi.z;
  }
};

PlaneBox box_of(const std::vector<OutlinePiece>& pieces) {
  PlaneBox box;
  for (const OutlinePiece& piece : pieces) box.grow(piece);
  return box;
}

OutlinePiece straight(const FlatPoint& a, const FlatPoint& b) { return {{a, b, b, b}, 1, 0, 0}; }

/// A piece of the least degree that is the same up to rounding, with the same ends.
OutlinePiece cubic_piece(const FlatPoint& a, const FlatPoint& b, const FlatPoint& c, const FlatPoint& d,
                         double tiny) {
  // Elevated pieces: a line has its thirds, a parabola has b = (a + 2 q) / 3 and c = (2 q + d) / 3.
  const FlatPoint line = (a * 2 + d) * (1.0 / 3), other = (a + d * 2) * (1.0 / 3);
  if (size_of(b - line) <= tiny && size_of(c - other) <= tiny) return straight(a, d);
  const FlatPoint q = (b * 3 - a) * 0.5, r = (c * 3 - d) * 0.5;
  if (size_of(q - r) <= tiny) return {{a, (q + r) * 0.5, d, d}, 2, 0, 0};
  return {{a, b, c, d}, 3, 0, 0};
}

/// Between q and r the parabola with p at -1, q at 0 and r at 1: its slope at q is (r - p) / 2.
OutlinePiece quadratic_piece(const FlatPoint& p, const FlatPoint& q, const FlatPoint& r) {
  const FlatPoint control = q + (r - p) * 0.25;
  return {{q, control, r, r}, 2, 0, 0};
}

bool has_length(const OutlinePiece& piece) {
  return !(piece.p[0] == piece.p[1] && piece.p[0] == piece.p[2] && piece.p[0] == piece.p[3]);
}

/// Whether all control points are on one straight line, up to rounding.
bool is_straight(const OutlinePiece& piece) {
  std::size_t far = 1;
  const auto from_begin = [&](std::size_t k) { return piece.p[k] - piece.p[0]; };
  for (std::size_t k = 2; k < 4; ++k)
    if (size_of(from_begin(k)) > size_of(from_begin(far))) far = k;
  const FlatPoint along = from_begin(far);
  for (std::size_t k = 1; k < 4; ++k) {
    const FlatPoint d = from_begin(k);
    if (std::abs(d.x * along.z - d.z * along.x) > 0x1p-48 * dot(along, along)) return false;
  }
  return true;
}

struct ValueAndSlope {
  double value, slope;
};

/// The polynomial with Bernstein coefficients b at s by de Casteljau's scheme; exact at 0 and 1.
ValueAndSlope bernstein(const double (&b)[4], int degree, double s) {
  const double r = 1 - s;
  double c0 = r * b[0] + s * b[1], c1 = r * b[1] + s * b[2];
  if (degree == 3) {
    const double c2 = r * b[2] + s * b[3];
    c0 = r * c0 + s * c1, c1 = r * c1 + s * c2;
  }
  return {r * c0 + s * c1, degree * (c1 - c0)};
}

/// The only change of sign between lo and hi, at which the signs differ: Newton's method, kept between them.
double root_between(const double (&b)[4], int degree, double lo, double hi, double at_lo, double at_hi) {
  const bool rises = at_lo < 0;
  // A bound on the second derivative.
  double bend = std::abs((b[2] - b[1]) - (b[1] - b[0]));
  if (degree == 3) bend = std::max(bend, std::abs((b[3] - b[2]) - (b[2] - b[1])));
  bend *= degree * (degree - 1);
  double s = lo + (hi - lo) * (at_lo / (at_lo - at_hi));
  for (int i = 0; i < 80; ++i) {
    if (!(s > lo && s < hi)) s = lo + 0.5 * (hi - lo);
    if (!(s > lo && s < hi)) return s;
    const auto [value, slope] = bernstein(b, degree, s);
    ((value < 0) == rises ? lo : hi) = s;
    const double step = value / slope;
    if (std::abs(step) <= 0x1p-54 * s) return s;
    // What is left after this step is less than step^2 bend / |slope|.
    if (step * step * bend <= 0x1p-55 * s * std::abs(slope)) return std::clamp(s - step, lo, hi);
    // A step to where it has been halves what is left next.
    s -= step;
  }
  return s;
}

/// Where the derivative of a piece's polynomial is zero, in ascending order.
int turning_places(const double (&b)[4], int degree, double (&out)[2]) {
  const double d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2];
  int n = 0;
  const auto keep = [&](double s) {
    if (s > 0 && s < 1) out[n++] = s;
  };
  if (degree == 2) {
    keep(d0 / (d0 - d1));
    return n;
  }
  // d0 (1-s)^2 + 2 d1 s (1-s) + d2 s^2, in terms of s / (1-s).
  const double square = d1 * d1 - d0 * d2;
  if (!(square > 0)) return 0;
  const double q = -(d1 + std::copysign(std::sqrt(square), d1));
  keep(q / (q + d2)), keep(d0 / (d0 + q));
  if (n == 2 && out[1] < out[0]) std::swap(out[0], out[1]);
  return n;
}

}  // namespace

OutlinePoint OutlinePiece::at(double s) const {
  const double r = 1 - s;
  const FlatPoint d0 = p[1] - p[0], d1 = p[2] - p[1], d2 = p[3] - p[2];
  if (degree == 1) return {p[0] * r + p[1] * s, d0, {0, 0}};
  const FlatPoint a = p[0] * r + p[1] * s, b = p[1] * r + p[2] * s;
  if (degree == 2) return {a * r + b * s, (d0 * r + d1 * s) * 2, (d1 - d0) * 2};
  const FlatPoint c = p[2] * r + p[3] * s, ab = a * r + b * s, bc = b * r + c * s;
  return {ab * r + bc * s, (bc - ab) * 3, ((d1 - d0) * r + (d2 - d1) * s) * 6};
}

FlatPoint OutlinePiece::right(double s) const {
  FlatPoint along = at(s).slope;
  double l = std::sqrt(dot(along, along));
  if (!(l > 0)) along = p[3] - p[0], l = std::sqrt(dot(along, along));
  return l > 0 ? FlatPoint{along.z / l, -along.x / l} : FlatPoint{1, 0};
}

double OutlinePiece::nearest(const FlatPoint& q) const {
  if (degree == 1) {
    const FlatPoint d = p[1] - p[0];
    return std::clamp(dot(q - p[0], d) / dot(d, d), 0.0, 1.0);
  }
  const auto distance2 = [&](double s) {
    const FlatPoint away = at(s).at - q;
    return dot(away, away);
  };
  // Newton's method from each sample that is nearer than its neighbours finds points that are on the piece
  // but where it turns sharply.
  constexpr int kSteps = 12;
  double d2[kSteps + 1], best = 0, least = HUGE_VAL;
  bool settled = false;
  for (int i = 0; i <= kSteps; ++i) d2[i] = distance2(static_cast<double>(i) / kSteps);
  for (int i = 0; i <= kSteps; ++i) {
    if ((i > 0 && d2[i - 1] < d2[i]) || (i < kSteps && d2[i + 1] < d2[i])) continue;
    double s = static_cast<double>(i) / kSteps;
    if (d2[i] < least) least = d2[i], best = s;
    bool done = false;
    for (int k = 0; k < 12 && !done; ++k) {
      const OutlinePoint here = at(s);
      const FlatPoint away = here.at - q;
      const double slope = dot(away, here.slope), speed = dot(here.slope, here.slope);
      const double curve = speed + dot(away, here.bend);
      const double step = slope / (curve > 0.25 * speed ? curve : speed);
      if (!std::isfinite(step)) break;
      const double next = std::clamp(s - std::clamp(step, -0.125, 0.125), 0.0, 1.0);
      done = std::abs(next - s) < 0x1p-40;
      s = next;
    }
    if (const double here = distance2(s); here <= least) least = here, best = s, settled = done;
  }
  const double size = std::max({size_of(p[1] - p[0]), size_of(p[2] - p[0]), size_of(p[3] - p[0])});
  if (settled && least <= 0x1p-44 * size * size) return best;
  // All places at which the distance turns, in terms of v = 2 s - 1.
  double slopes[6] = {};
  for (int axis = 0; axis < 2; ++axis) {
    const auto at = [&](int k) { return axis == 0 ? p[k].x - q.x : p[k].z - q.z; };
    double c[4] = {};
    if (degree == 2) {
      c[0] = (at(0) + 2 * at(1) + at(2)) / 4, c[1] = (at(2) - at(0)) / 2;
      c[2] = (at(0) - 2 * at(1) + at(2)) / 4;
    } else {
      c[0] = (at(0) + 3 * at(1) + 3 * at(2) + at(3)) / 8, c[1] = 3 * ((at(3) - at(0)) + (at(2) - at(1))) / 8;
      c[2] = 3 * ((at(0) - at(1)) + (at(3) - at(2))) / 8, c[3] = ((at(3) - at(0)) - 3 * (at(2) - at(1))) / 8;
    }
    for (int i = 0; i <= degree; ++i)
      for (int k = 1; k <= degree; ++k) slopes[i + k - 1] += c[i] * k * c[k];
  }
  SignChanges turns;
  find_sign_changes(slopes, 2 * degree - 1, roots::Method::automatic, kMaxRayDegree, turns);
  for (int i = 0; i < turns.count; ++i) {
    const double s = 0.5 + 0.5 * turns.s[i];
    if (const double here = distance2(s); here < least) least = here, best = s;
  }
  return best;
}

/// Appends a piece; one on a straight line as lines between the places at which it turns back.
static void append(const OutlinePiece& piece, std::vector<OutlinePiece>& pieces) {
  if (piece.degree == 1 || !is_straight(piece)) return pieces.push_back(piece);
  FlatPoint line{0, 0};
  for (const FlatPoint& p : piece.p)
    if (const FlatPoint d = p - piece.p[0]; size_of(d) > size_of(line)) line = d;
  double along[4], cut[2];
  for (int k = 0; k < 4; ++k) along[k] = dot(piece.p[k] - piece.p[0], line);
  FlatPoint from = piece.p[0];
  const int turns = turning_places(along, piece.degree, cut);
  for (int i = 0; i < turns; ++i) {
    const FlatPoint at = piece.at(cut[i]).at;
    pieces.push_back(straight(from, at));
    from = at;
  }
  pieces.push_back(straight(from, piece.p[3]));
}

std::vector<OutlinePiece> outline_pieces(const PlaneOutline& p, OutlineCurve curve, double rounding) {
  std::vector<OutlinePiece> pieces;
  const std::size_t n = p.size(),
                    before = curve == OutlineCurve::quadratic || curve == OutlineCurve::cubic ? 1 : 0;
  const std::size_t after = curve == OutlineCurve::cubic ? 1 : 0;
  if (n < before + after + 2) return pieces;
  const std::size_t end = n - 1 - after;
  for (std::size_t i = before; i < end; i += curve == OutlineCurve::bezier ? 3 : 1) {
    switch (curve) {
      case OutlineCurve::linear:
        pieces.push_back(straight(p[i], p[i + 1]));
        break;
      case OutlineCurve::quadratic:
        append(quadratic_piece(p[i - 1], p[i], p[i + 1]), pieces);
        break;
      case OutlineCurve::cubic: {
        // At a point the curve goes as half the chord between its neighbours; a third of that to the control.
        const FlatPoint a = (p[i + 1] - p[i - 1]) * (1.0 / 6), b = (p[i + 2] - p[i]) * (1.0 / 6);
        append(cubic_piece(p[i], p[i] + a, p[i + 1] - b, p[i + 1], rounding), pieces);
        break;
      }
      case OutlineCurve::bezier:
        if (i + 3 < n) append(cubic_piece(p[i], p[i + 1], p[i + 2], p[i + 3], rounding), pieces);
        break;
    }
  }
  if (pieces.empty()) return pieces;
  if (const FlatPoint first = pieces.front().p[0], last = pieces.back().p[3]; !(first == last))
    pieces.push_back(straight(last, first));
  std::erase_if(pieces, [](const OutlinePiece& piece) { return !has_length(piece); });
  const double count = static_cast<double>(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i)
    pieces[i].begin = static_cast<double>(i) / count, pieces[i].per_one = 1 / count;
  return pieces;
}

/// The control points of a piece in the direction whose first coordinates are less.
static std::array<FlatPoint, 4> directed(const OutlinePiece& piece) {
  std::array<FlatPoint, 4> forward, backward;
  for (int k = 0; k < 4; ++k)
    forward[k] = piece.p[std::min(k, piece.degree)], backward[k] = piece.p[std::max(piece.degree - k, 0)];
  const auto less = [](const FlatPoint& a, const FlatPoint& b) { return a.x != b.x ? a.x < b.x : a.z < b.z; };
  return std::lexicographical_compare(backward.begin(), backward.end(), forward.begin(), forward.end(), less)
             ? backward
             : forward;
}

/// Pieces without those that lie on each other two by two: between them is nothing, and beside them both
/// sides are inside, or both outside.
static std::vector<std::vector<OutlinePiece>> without_pairs(std::vector<std::vector<OutlinePiece>> outlines) {
  using Key = std::array<double, 9>;
  const auto key_of = [](const OutlinePiece& piece) {
    Key key{static_cast<double>(piece.degree)};
    const std::array<FlatPoint, 4> p = directed(piece);
    for (std::size_t k = 0; k < 4; ++k) key[2 * k + 1] = p[k].x, key[2 * k + 2] = p[k].z;
    return key;
  };
  std::map<Key, bool> odd;
  for (const auto& pieces : outlines)
    for (const OutlinePiece& piece : pieces) odd[key_of(piece)] = !odd[key_of(piece)];
  // Of an odd number the first one stays.
  for (auto& pieces : outlines)
    std::erase_if(pieces,
                  [&](const OutlinePiece& piece) { return !std::exchange(odd[key_of(piece)], false); });
  return outlines;
}

OutlineSet::OutlineSet(const std::vector<std::vector<OutlinePiece>>& described) {
  const std::vector<std::vector<OutlinePiece>> outlines = without_pairs(described);
  // Groups of outlines whose boxes meet. Joined boxes may meet others in turn.
  struct Joined {
    PlaneBox box;
    std::vector<OutlinePiece> pieces;
  };
  std::vector<Joined> groups;
  for (const auto& pieces : outlines)
    if (!pieces.empty()) groups.push_back({box_of(pieces), pieces});
  const auto by_place = [](const Joined& a, const Joined& b) {
    return a.box.lo.x != b.box.lo.x ? a.box.lo.x < b.box.lo.x : a.box.lo.z < b.box.lo.z;
  };
  std::sort(groups.begin(), groups.end(), by_place);
  for (bool again = true; again;) {
    again = false;
    // What ends before the next one begins meets none of those that follow.
    std::vector<Joined> open, done;
    for (Joined& group : groups) {
      std::vector<Joined> still;
      const double begin = group.box.lo.x;
      for (Joined& other : open) {
        if (other.box.meets(group.box)) {
          group.box.grow(other.box.lo), group.box.grow(other.box.hi);
          group.pieces.insert(group.pieces.end(), other.pieces.begin(), other.pieces.end());
          again = true;
        } else {
          (other.box.hi.x < begin ? done : still).push_back(std::move(other));
        }
      }
      still.push_back(std::move(group));
      open = std::move(still);
    }
    for (Joined& group : open) done.push_back(std::move(group));
    groups = std::move(done);
    std::sort(groups.begin(), groups.end(), by_place);
  }
  PlaneBox all;
  for (const Joined& group : groups) {
    all.grow(group.box.lo), all.grow(group.box.hi);
    std::vector<std::uint32_t> order(group.pieces.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto begin = static_cast<std::uint32_t>(nodes_.size());
    build(order, 0, order.size(), group.pieces);
    groups_.push_back({begin, static_cast<std::uint32_t>(nodes_.size()), group.box.lo, group.box.hi});
  }
  if (groups.empty()) return;
  lo_ = all.lo, hi_ = all.hi;
  reach_ = std::max(size_of(lo_), size_of(hi_));
  for (int c = 0; c < 4; ++c) {
    x_[c].resize(pieces_.size() + kPadding), z_[c].resize(pieces_.size() + kPadding);
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      x_[c][i] = pieces_[i].p[c].x, z_[c][i] = pieces_[i].p[c].z;
  }
}

void OutlineSet::build(std::vector<std::uint32_t>& order, std::size_t begin, std::size_t end,
                       const std::vector<OutlinePiece>& pieces) {
  constexpr std::size_t kLeaf = 8;
  PlaneBox box;
  for (std::size_t i = begin; i < end; ++i) box.grow(pieces[order[i]]);
  const std::size_t here = nodes_.size();
  const FlatPoint middle = (box.lo + box.hi) * 0.5;
  const FlatPoint half{std::max(box.hi.x - middle.x, middle.x - box.lo.x),
                       std::max(box.hi.z - middle.z, middle.z - box.lo.z)};
  nodes_.push_back({middle, half, 0, static_cast<std::uint32_t>(pieces_.size()), 0});
  if (end - begin <= kLeaf) {
    nodes_[here].count = static_cast<std::uint32_t>(end - begin);
    for (std::size_t i = begin; i < end; ++i) pieces_.push_back(pieces[order[i]]);
  } else {
    // Whole leaves on one side.
    const std::size_t leaves = (end - begin + kLeaf - 1) / kLeaf, cut = begin + (leaves + 1) / 2 * kLeaf;
    const bool by_x = half.x > half.z;
    const auto key = [&](std::uint32_t i) {
      const OutlinePiece& piece = pieces[i];
      return by_x ? piece.p[0].x + piece.p[3].x : piece.p[0].z + piece.p[3].z;
    };
    const auto at = [&](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(cut), at(end), [&](std::uint32_t a, std::uint32_t b) {
      return key(a) != key(b) ? key(a) < key(b) : a < b;
    });
    build(order, begin, cut, pieces);
    build(order, cut, end, pieces);
  }
  nodes_[here].skip = static_cast<std::uint32_t>(nodes_.size());
}

std::size_t OutlineSet::bytes() const {
  return pieces_.size() * (sizeof(OutlinePiece) + 8 * sizeof(double)) + nodes_.size() * sizeof(OutlineNode) +
         groups_.size() * sizeof(Group);
}

void OutlineSet::find_roots(const PlaneLine& line, std::span<const std::uint32_t> candidates,
                            std::vector<OutlineRoot>& out) const {
  for (const std::uint32_t number : candidates) {
    const OutlinePiece& piece = pieces_[number];
    const double b[4] = {line.at(piece.p[0]), line.at(piece.p[1]), line.at(piece.p[2]), line.at(piece.p[3])};
    if (piece.degree == 1) {
      if ((b[0] < 0) != (b[1] < 0)) out.push_back({number, b[0] < 0, b[0] / (b[0] - b[1])});
      continue;
    }
    double cut[4] = {0}, value[4] = {b[0]}, turning[2];
    int n = 1;
    const int turns = turning_places(b, piece.degree, turning);
    for (int i = 0; i < turns; ++i)
      cut[n] = turning[i], value[n++] = bernstein(b, piece.degree, turning[i]).value;
    cut[n] = 1, value[n++] = b[piece.degree];
    for (int i = 0; i + 1 < n; ++i)
      if ((value[i] < 0) != (value[i + 1] < 0))
        out.push_back({number, value[i] < 0,
                       root_between(b, piece.degree, cut[i], cut[i + 1], value[i], value[i + 1])});
  }
}

bool OutlineSet::inside(const FlatPoint& p) const {
  // Crossings of the line through p along x, before it.
  const PlaneLine line{0, 1, -p.z};
  thread_local std::vector<OutlineRoot> roots;
  roots.clear();
  each_candidate<ScalarIsa>(line, 0, static_cast<std::uint32_t>(nodes_.size()),
                            [&](const std::uint32_t* numbers, int count) {
                              find_roots(line, {numbers, static_cast<std::size_t>(count)}, roots);
                            });
  bool odd = false;
  for (const OutlineRoot& root : roots) odd ^= pieces_[root.piece].at(root.s).at.x < p.x;
  return odd;
}

OutlineSet::Nearest OutlineSet::nearest(const FlatPoint& q) const {
  Nearest best;
  best.d2 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < nodes_.size();) {
    const OutlineNode& node = nodes_[i];
    const double dx = std::max(std::abs(q.x - node.middle.x) - node.half.x, 0.0);
    const double dz = std::max(std::abs(q.z - node.middle.z) - node.half.z, 0.0);
    if (dx * dx + dz * dz > best.d2) {
      i = node.skip;
      continue;
    }
    ++i;
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      const double s = pieces_[k].nearest(q);
      const FlatPoint away = pieces_[k].at(s).at - q;
      if (const double d2 = dot(away, away); d2 < best.d2) best = {k, s, d2};
    }
  }
  return best;
}

}  // namespace oktett
