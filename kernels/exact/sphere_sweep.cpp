#include "kernels/exact/sphere_sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/exact/ray_polynomial.h"

namespace oktett {
namespace {

using SweptPiece = SphereSweepElement::Piece;
using SweptNode = SphereSweepElement::Node;

/// A sphere as a point of four dimensions.
struct Sphere4 {
  Vec3d c;
  double r;
};
Sphere4 operator+(const Sphere4& a, const Sphere4& b) { return {a.c + b.c, a.r + b.r}; }
Sphere4 operator-(const Sphere4& a, const Sphere4& b) { return {a.c - b.c, a.r - b.r}; }
Sphere4 operator*(const Sphere4& a, double s) { return {a.c * s, a.r * s}; }

/// Bezier's control points of each piece; of two spheres for degree 1.
struct Control {
  Sphere4 p[4];
};

std::vector<Control> controls_of(const std::vector<Sphere4>& s, SphereSweepShape::Curve curve) {
  std::vector<Control> all;
  const std::size_t n = s.size();
  switch (curve) {
    case SphereSweepShape::Curve::linear:
      for (std::size_t i = 0; i + 1 < n; ++i) all.push_back({{s[i], s[i + 1], s[i + 1], s[i + 1]}});
      break;
    case SphereSweepShape::Curve::cubic:
      // At a sphere the curve goes as half the chord between its neighbours; a third of that to the control.
      for (std::size_t i = 1; i + 2 < n; ++i)
        all.push_back({{s[i], s[i] + (s[i + 1] - s[i - 1]) * (1.0 / 6),
                        s[i + 1] - (s[i + 2] - s[i]) * (1.0 / 6), s[i + 1]}});
      break;
    case SphereSweepShape::Curve::b_spline:
      for (std::size_t i = 0; i + 3 < n; ++i) {
        const Sphere4 a = s[i + 1] * (2.0 / 3) + s[i + 2] * (1.0 / 3);
        const Sphere4 b = s[i + 1] * (1.0 / 3) + s[i + 2] * (2.0 / 3);
        const auto knot = [&](std::size_t k) { return (s[k - 1] + s[k] * 4 + s[k + 1]) * (1.0 / 6); };
        all.push_back({{knot(i + 1), a, b, knot(i + 2)}});
      }
      break;
  }
  return all;
}

SweptPiece piece_of(const Control& control, int degree) {
  const Sphere4(&p)[4] = control.p;
  Sphere4 power[4] = {};
  if (degree == 1) {
    power[0] = (p[0] + p[1]) * 0.5, power[1] = (p[1] - p[0]) * 0.5;
  } else {
    power[0] = (p[0] + (p[1] + p[2]) * 3 + p[3]) * 0.125;
    power[1] = ((p[3] - p[0]) + (p[2] - p[1])) * 0.375;
    power[2] = ((p[0] - p[1]) + (p[3] - p[2])) * 0.375;
    power[3] = ((p[3] - p[0]) - (p[2] - p[1]) * 3) * 0.125;
  }
  SweptPiece piece{};
  double most = 0;
  piece.lo = piece.hi = p[0].c;
  for (int k = 0; k < 4; ++k) {
    piece.c[k] = power[k].c, piece.r[k] = power[k].r;
    piece.lo = min(piece.lo, p[k].c), piece.hi = max(piece.hi, p[k].c);
    most = std::max(most, std::abs(p[k].r));
  }
  const double room = most + 0x1p-40;
  piece.lo -= Vec3d{room, room, room}, piece.hi += Vec3d{room, room, room};
  return piece;
}

/// Appends the nodes over the pieces from `begin` to `end`, which are sorted on the way.
void build_sweep(SphereSweepElement& e, std::size_t begin, std::size_t end) {
  constexpr std::size_t kLeaf = 2;
  Vec3d lo = e.pieces[begin].lo, hi = e.pieces[begin].hi;
  for (std::size_t i = begin; i < end; ++i) lo = min(lo, e.pieces[i].lo), hi = max(hi, e.pieces[i].hi);
  const std::size_t here = e.nodes.size();
  e.nodes.push_back({lo, hi, 0, static_cast<std::uint32_t>(begin), 0});
  if (end - begin <= kLeaf) {
    e.nodes[here].count = static_cast<std::uint32_t>(end - begin);
  } else {
    const Vec3d size = hi - lo;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t cut = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return e.pieces.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(cut), at(end), [axis](const SweptPiece& a, const SweptPiece& b) {
      return a.lo[axis] + a.hi[axis] < b.lo[axis] + b.hi[axis];
    });
    build_sweep(e, begin, cut);
    build_sweep(e, cut, end);
  }
  e.nodes[here].skip = static_cast<std::uint32_t>(e.nodes.size());
}

double polynomial_at(const double* c, int degree, double v) {
  double y = c[degree];
  for (int k = degree; k > 0; --k) y = y * v + c[k - 1];
  return y;
}

/// out += scale a b, polynomials of these degrees.
void add_product(const double* a, int m, const double* b, int n, double scale, double* out) {
  for (int i = 0; i <= m; ++i)
    for (int k = 0; k <= n; ++k) out[i + k] += scale * a[i] * b[k];
}

void derive(const double* c, int degree, double* out) {
  for (int k = 1; k <= degree; ++k) out[k - 1] = k * c[k];
}

/// From where to where a ray is inside of some sphere.
struct InsideOf {
  double begin, end;
};

/// A ray in lengths of the own space, about the point of it that is nearest to the origin.
class SweptRay {
 public:
  SweptRay(const Vec3d& o, const Vec3d& d) {
    const double dd = dot(d, d);
    scale_ = 1 / std::sqrt(dd), shift_ = -(dot(o, d) / dd);
    p_ = o + d * shift_, u_ = d * scale_;
    make_basis(u_, x_, y_);
  }
  double to_t(double s) const { return shift_ + s * scale_; }

  bool meets(const Vec3d& lo, const Vec3d& hi) const {
    double near = -HUGE_VAL, far = HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
      if (u_[k] == 0) {
        if (!(lo[k] <= p_[k] && p_[k] <= hi[k])) return false;
        continue;
      }
      const double a = (lo[k] - p_[k]) / u_[k], b = (hi[k] - p_[k]) / u_[k];
      near = std::max(near, std::min(a, b)), far = std::min(far, std::max(a, b));
    }
    return near <= far + 0x1p-40 * (std::abs(near) + std::abs(far));
  }

  /// Appends where the ray is inside of a piece.
  void find(const SweptPiece& piece, int n, std::vector<InsideOf>& out) const {
    double b[4], x[4], y[4];
    for (int k = 0; k <= n; ++k) {
      const Vec3d c = k == 0 ? piece.c[0] - p_ : piece.c[k];
      b[k] = dot(u_, c), x[k] = dot(x_, c), y[k] = dot(y_, c);
    }
    // The squared half chord.
    double chord[7] = {};
    add_product(piece.r, n, piece.r, n, 1, chord);
    add_product(x, n, x, n, -1, chord), add_product(y, n, y, n, -1, chord);
    SignChanges ends;
    find_sign_changes(chord, 2 * n, roots::Method::automatic, kMaxRayDegree, ends);
    // Without a change of sign it may yet be zero somewhere.
    bool positive = ends.count > 0 && ends.turn[0] < 0;
    if (ends.count == 0)
      for (const double v : {-1.0, 0.0, 1.0}) positive |= polynomial_at(chord, 2 * n, v) > 0;
    if (ends.count == 0 && !positive) return;
    // Where one of the ends may turn.
    double db[3] = {}, dchord[6] = {}, square[5] = {}, turning[kMaxRayDegree + 1] = {};
    derive(b, n, db), derive(chord, 2 * n, dchord);
    add_product(db, n - 1, db, n - 1, 4, square);
    add_product(square, 2 * n - 2, chord, 2 * n, 1, turning);
    add_product(dchord, 2 * n - 1, dchord, 2 * n - 1, -1, turning);
    SignChanges turns, widest;
    find_sign_changes(turning, 4 * n - 2, roots::Method::automatic, kMaxRayDegree, turns);
    // Where the slopes of b and of the chord are zero together, it has a double root, or two that are close.
    find_sign_changes(dchord, 2 * n - 1, roots::Method::automatic, kMaxRayDegree, widest);
    double from = -1;
    for (int i = 0; i <= ends.count; ++i) {
      const double to = i < ends.count ? ends.s[i] : 1;
      if (positive) {
        InsideOf range{HUGE_VAL, -HUGE_VAL};
        const auto look = [&](double v) {
          const double middle = polynomial_at(b, n, v),
                       half = std::sqrt(std::max(polynomial_at(chord, 2 * n, v), 0.0));
          range = {std::min(range.begin, middle - half), std::max(range.end, middle + half)};
        };
        look(from), look(to);
        for (const SignChanges* places : {&turns, &widest})
          for (int k = 0; k < places->count; ++k)
            if (from < places->s[k] && places->s[k] < to) look(places->s[k]);
        if (range.begin < range.end) out.push_back(range);
      }
      from = to, positive = !positive;
    }
  }

 private:
  Vec3d p_, u_, x_, y_;
  double shift_, scale_;
};

/// The sphere that reaches farthest beyond p.
struct Reaching {
  double value = HUGE_VAL;  ///< the squared distance from its centre less the squared radius
  Vec3d center;
};

void reach_piece(const SweptPiece& piece, int n, const Vec3d& p, Reaching& best) {
  double f[7] = {}, slope[6] = {};
  for (int axis = 0; axis < 3; ++axis) {
    double c[4];
    for (int k = 0; k <= n; ++k) c[k] = piece.c[k][axis] - (k == 0 ? p[axis] : 0);
    add_product(c, n, c, n, 1, f);
  }
  add_product(piece.r, n, piece.r, n, -1, f);
  derive(f, 2 * n, slope);
  SignChanges turns;
  find_sign_changes(slope, 2 * n - 1, roots::Method::automatic, kMaxRayDegree, turns);
  const auto look = [&](double v) {
    Vec3d c = piece.c[n];
    for (int k = n; k > 0; --k) c = c * v + piece.c[k - 1];
    const double r = polynomial_at(piece.r, n, v), value = dot(p - c, p - c) - r * r;
    if (value < best.value) best = {value, c};
  };
  look(-1), look(1);
  for (int i = 0; i < turns.count; ++i) look(turns.s[i]);
}

/// A bound from below on the value of all that is in a box: its spheres are in there, and one that holds p
/// has p in the box.
bool may_reach(const Vec3d& lo, const Vec3d& hi, const Vec3d& p, double best) {
  double d2 = 0;
  for (int k = 0; k < 3; ++k) {
    const double away = std::max({lo[k] - p[k], p[k] - hi[k], 0.0});
    d2 += away * away;
  }
  // The squared distance less the squared radius is at least the square of the distance from the sphere.
  return d2 == 0 || d2 < best;
}

Reaching reach(const SphereSweepElement& e, const Vec3d& p) {
  Reaching best;
  for (std::size_t i = 0; i < e.nodes.size();) {
    const SweptNode& node = e.nodes[i];
    if (!may_reach(node.lo, node.hi, p, best.value)) {
      i = node.skip;
      continue;
    }
    ++i;
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k)
      reach_piece(e.pieces[k], e.degree, p, best);
  }
  return best;
}

}  // namespace

std::size_t SphereSweepPool::bytes() const {
  std::size_t sum = ExactPool<SphereSweepElement>::bytes();
  for (const SphereSweepElement& e : elements)
    sum += e.pieces.size() * sizeof(SweptPiece) + e.nodes.size() * sizeof(SweptNode);
  return sum;
}

void SphereSweep::add(Pool& pool, const SphereSweepShape& s, const ExactPlace& place) {
  std::vector<Sphere4> spheres;
  for (const SweptSphere& sphere : s.spheres) spheres.push_back({sphere.center, sphere.radius});
  const auto box_of = [&](const std::vector<Control>& controls, Vec3d& lo, Vec3d& hi) {
    lo = Vec3d{HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi = -lo;
    double most = 0;
    for (const Control& control : controls)
      for (const Sphere4& p : control.p) {
        const Vec3d r = Vec3d{1, 1, 1} * std::abs(p.r);
        lo = min(lo, p.c - r), hi = max(hi, p.c + r), most = std::max(most, std::abs(p.r));
      }
    return most;
  };
  Vec3d lo, hi;
  const double most = box_of(controls_of(spheres, s.curve), lo, hi);
  if (!(most > 0)) return;
  const Vec3d middle = (lo + hi) * 0.5;
  const double size = 0.5 * max_component(hi - lo);
  if (!std::isfinite(size + length(middle))) return;
  for (Sphere4& sphere : spheres) sphere = {(sphere.c - middle) / size, sphere.r / size};
  SphereSweepElement e;
  e.degree = s.curve == SphereSweepShape::Curve::linear ? 1 : 3;
  for (const Control& control : controls_of(spheres, s.curve))
    e.pieces.push_back(piece_of(control, e.degree));
  build_sweep(e, 0, e.pieces.size());
  lo = e.nodes[0].lo, hi = e.nodes[0].hi;
  add_element(pool, e, place.to_world * Affine::translation(middle) * Affine::scaling({size, size, size}),
              place);
  add_cell(pool, lo, hi);
}

int SphereSweep::list(const SphereSweepElement& e, const Vec3d& o, const Vec3d& d, double begin, int room,
                      double* t, double& first, double& up_to) {
  thread_local std::vector<InsideOf> found;
  found.clear();
  const SweptRay ray(o, d);
  for (std::size_t i = 0; i < e.nodes.size();) {
    const SweptNode& node = e.nodes[i];
    if (!ray.meets(node.lo, node.hi)) {
      i = node.skip;
      continue;
    }
    ++i;
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k)
      ray.find(e.pieces[k], e.degree, found);
  }
  std::sort(found.begin(), found.end(), [](const InsideOf& a, const InsideOf& b) {
    return a.begin != b.begin ? a.begin < b.begin : a.end < b.end;
  });
  int count = 0;
  const auto push = [&](double s, double turn) {
    const double place = ray.to_t(s);
    if (place < begin) return true;
    if (count == room) {
      up_to = place;
      return false;
    }
    if (count == 0) first = turn;
    t[count++] = place;
    return true;
  };
  // Gaps that rounding may have made where pieces meet are closed.
  constexpr double kGap = 0x1p-36;
  for (std::size_t i = 0; i < found.size();) {
    double end = found[i].end;
    const double start = found[i].begin;
    for (++i; i < found.size() && found[i].begin <= end + kGap; ++i) end = std::max(end, found[i].end);
    if (!push(start, -1) || !push(end, 1)) break;
  }
  return count;
}

Slope SphereSweep::slope_at(const Pool& pool, std::size_t i, int, const Vec3d& p) {
  const Reaching best = reach(pool.elements[i], p);
  return {best.value, (p - best.center) * 2};
}

bool SphereSweep::inside(const Pool& pool, std::size_t i, const Vec3d& p) {
  return reach(pool.elements[i], p).value < 0;
}

}  // namespace oktett
