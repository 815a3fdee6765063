/// \file Polynomials, blobs of inverse squares and surfaces of revolution, from the equations of the sources.

#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/exact/lathe.h"
#include "kernels/exact/polynomial_expression.h"
#include "verify/oracles/exact_families.h"

namespace oktett {

namespace {

using Function = std::function<long double(const Vec3l&)>;

/// How far outside of a box p is, negative inside.
long double outside(const Vec3d& lo, const Vec3d& hi, const Vec3l& p) {
  long double d = -HUGE_VALL;
  for (int k = 0; k < 3; ++k) d = std::max({d, lo[k] - p[k], p[k] - hi[k]});
  return d;
}

/// Cuts what `f` describes by a box.
void cut_by_box(ExactOracle& o, const Function& f, const Vec3d& lo, const Vec3d& hi, bool open) {
  o.lo = lo, o.hi = hi;
  const auto box = [lo, hi](const Vec3l& p) { return outside(lo, hi, p); };
  if (open) {
    o.f = f, o.where = box;
  } else {
    o.f = [f, box](const Vec3l& p) { return std::max(f(p), box(p)); };
  }
}

long double power(long double x, int n) {
  long double y = 1;
  for (; n > 0; --n) y *= x;
  return y;
}

ExactOracle polynomial(std::string name, const std::string& equation, const Function& f, const Vec3d& lo,
                       const Vec3d& hi, bool open = false) {
  PolynomialShape s;
  s.terms = expand_polynomial(equation);
  s.lo = lo, s.hi = hi, s.open = open;
  ExactOracle o;
  o.name = std::move(name), o.shape = {s};
  cut_by_box(o, f, lo, hi, open);
  return o;
}

Vec3d cube(double r) { return {r, r, r}; }

/// Terms of random coefficients, all of them or a few, in any box.
ExactOracle random_polynomial(CaseRandom& random) {
  const int degree = 1 + static_cast<int>(random.unit() * 8);
  const double share = random.unit() < 0.5 ? 1 : 0.3;
  PolynomialShape s;
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; i + j <= degree; ++j)
      for (int k = 0; i + j + k <= degree; ++k)
        if (random.unit() < share || i == degree)
          s.terms.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(j),
                             static_cast<std::uint8_t>(k), random.vector().x});
  const Vec3d middle = random.vector() * (random.unit() < 0.3 ? 3.0 : 0.3);
  const Vec3d half{0.4 + random.unit(), 0.4 + random.unit(), 0.4 + random.unit()};
  s.lo = middle - half, s.hi = middle + half;
  s.open = random.unit() < 0.5;
  ExactOracle o;
  o.name = "polynomial", o.shape = {s};
  const auto terms = s.terms;
  const auto f = [terms](const Vec3l& p) {
    long double sum = 0;
    for (const Monomial& m : terms) sum += m.c * power(p.x, m.i) * power(p.y, m.j) * power(p.z, m.k);
    return sum;
  };
  cut_by_box(o, f, s.lo, s.hi, s.open);
  return o;
}

/// x^n + y^n + z^n = 1 (Melcher).
ExactOracle even_powers(CaseRandom& random) {
  const int n = 2 + 2 * static_cast<int>(random.unit() * 6);
  const std::string k = std::to_string(n);
  return polynomial(
      "polynomial_even", "x^" + k + " + y^" + k + " = 1 - z^" + k,
      [n](const Vec3l& p) { return power(p.x, n) + power(p.y, n) + power(p.z, n) - 1; }, cube(-1.1),
      cube(1.1));
}

/// Barth's sextic, with 65 double points.
ExactOracle barth(CaseRandom&) {
  return polynomial(
      "polynomial_barth",
      "4*((1+sqrt(5))^2/4*x^2-y^2)*((1+sqrt(5))^2/4*y^2-z^2)*((1+sqrt(5))^2/4*z^2-x^2)"
      " - (2+sqrt(5))*(x^2+y^2+z^2-1)^2",
      [](const Vec3l& p) {
        const long double phi = (1 + std::sqrt(5.0L)) / 2, q = phi * phi;
        const long double x = p.x * p.x, y = p.y * p.y, z = p.z * p.z, r = x + y + z - 1;
        return 4 * (q * x - y) * (q * y - z) * (q * z - x) - (1 + 2 * phi) * r * r;
      },
      cube(-1.7), cube(1.7), true);
}

/// T_8(x) + T_8(y) + T_8(z) = 0 with Chebyshev's polynomials (Chmutov).
ExactOracle chmutov(CaseRandom&) {
  const auto t8 = [](const std::string& x) {
    return "128*" + x + "^8-256*" + x + "^6+160*" + x + "^4-32*" + x + "^2+1";
  };
  return polynomial(
      "polynomial_chmutov", t8("x") + "+" + t8("y") + "+" + t8("z"),
      [](const Vec3l& p) {
        long double sum = 0;
        for (int k = 0; k < 3; ++k) {
          const long double a = 2 * p[k] * p[k] - 1, b = 2 * a * a - 1;
          sum += 2 * b * b - 1;
        }
        return sum;
      },
      cube(-1.05), cube(1.05));
}

/// The potential of the sources of a blob.
long double potential(const BlobShape& s, const Vec3l& p) {
  long double sum = 0;
  for (const BlobSource& source : s.sources) {
    const Vec3l v{p.x - source.at.x, p.y - source.at.y, p.z - source.at.z};
    const Vec3l d{source.direction.x, source.direction.y, source.direction.z};
    long double q = dot(v, v);
    if (source.kind == BlobSource::Kind::line) {
      const Vec3l c = cross(v, d);
      q = dot(c, c) / dot(d, d);
    } else if (source.kind == BlobSource::Kind::plane) {
      const long double a = dot(p, d) / std::sqrt(dot(d, d)) - source.offset;
      q = a * a;
    }
    sum += source.weight / q;
  }
  return sum;
}

ExactOracle draw_blob(CaseRandom& random, const char* name, int most, bool endless) {
  BlobShape s;
  const int count = 1 + static_cast<int>(random.unit() * most);
  for (int i = 0; i < count; ++i) {
    BlobSource source;
    source.at = random.vector();
    source.direction = random.vector();
    source.offset = 0.5 * random.vector().x;
    source.weight = i > 0 && random.unit() < 0.2 ? -0.3 * random.unit() : 0.1 + random.unit();
    if (endless && random.unit() < 0.6)
      source.kind = random.unit() < 0.5 ? BlobSource::Kind::line : BlobSource::Kind::plane;
    s.sources.push_back(source);
  }
  s.iso = count * (1 + 6 * random.unit());
  ExactOracle o;
  o.name = name;
  // About as even as a distance.
  const auto f = [s](const Vec3l& p) {
    return 1 / std::sqrt(std::max(potential(s, p), 0.01L * s.iso)) -
           1 / std::sqrt(static_cast<long double>(s.iso));
  };
  if (endless) {
    s.bounded = true, s.open = random.unit() < 0.3;
    s.lo = cube(-1.2), s.hi = {1.2, 1.0, 1.4};
    o.shape = {s};
    cut_by_box(o, f, s.lo, s.hi, s.open);
  } else {
    o.shape = {s}, o.f = f;
    // No farther from a source than where all of them in one point would reach.
    double weight = 0;
    for (const BlobSource& source : s.sources) weight += std::max(source.weight, 0.0);
    o.lo = o.hi = s.sources[0].at;
    for (const BlobSource& source : s.sources) o.lo = min(o.lo, source.at), o.hi = max(o.hi, source.at);
    const double reach = std::sqrt(weight / s.iso);
    o.lo -= cube(reach), o.hi += cube(reach);
  }
  return o;
}
ExactOracle blob(CaseRandom& random) { return draw_blob(random, "blob", 4, false); }
ExactOracle large_blob(CaseRandom& random) { return draw_blob(random, "blob_large", 16, false); }
ExactOracle endless_blob(CaseRandom& random) { return draw_blob(random, "blob_endless", 4, true); }

/// How far outside of piece k of a profile: of its slab of height, or of its radius at that height by
/// Bezier's form, with i = y and j = 1 - y (Melcher), or straight, or for `sor` the square root of a cubic.
long double outside_piece(const RevolutionShape& s, std::size_t k, long double rho, long double height,
                          bool slab) {
  const ProfilePoint &p = s.points[k], &q = s.points[k + 1];
  const long double h = static_cast<long double>(q.height) - p.height;
  if (!(h > 0)) return HUGE_VALL;
  const long double ends = slab ? std::max(p.height - height, height - q.height) : -HUGE_VALL;
  const long double i = std::clamp((height - p.height) / h, 0.0L, 1.0L), j = 1 - i;
  if (s.profile == RevolutionShape::Profile::linear)
    return std::max(ends, rho - (q.radius * i + p.radius * j));
  const auto slope = [&](std::size_t at) {
    const ProfilePoint &a = s.points[at - 1], &b = s.points[at + 1];
    return (static_cast<long double>(b.radius) - a.radius) / (static_cast<long double>(b.height) - a.height);
  };
  const long double m = slope(k) * h / 3, n = slope(k + 1) * h / 3, r = p.radius, t = q.radius;
  if (s.profile == RevolutionShape::Profile::sor) {
    const long double square = t * t * i * i * i + 3 * (t * t - 2 * t * n) * i * i * j +
                               3 * (r * r + 2 * r * m) * i * j * j + r * r * j * j * j;
    return std::max(ends, rho - std::sqrt(std::max(square, 0.0L)));
  }
  return std::max(ends,
                  rho - (t * i * i * i + 3 * (t - n) * i * i * j + 3 * (r + m) * i * j * j + r * j * j * j));
}

ExactOracle revolution(CaseRandom& random, const char* name, RevolutionShape::Profile profile) {
  using Profile = RevolutionShape::Profile;
  RevolutionShape s;
  s.profile = profile, s.open = random.unit() < 0.3;
  const int count = 4 + static_cast<int>(random.unit() * 4);
  double y = random.vector().x;
  for (int i = 0; i < count; ++i) {
    const bool tip = profile == Profile::linear && random.unit() < 0.15;
    s.points.push_back({tip ? 0 : 0.45 + 0.4 * random.unit(), y});
    const bool ring = profile == Profile::linear && i > 0 && random.unit() < 0.2;
    y += ring ? 0 : 0.35 + 0.4 * random.unit();
  }
  while (s.points[s.points.size() - 2].height == s.points.back().height) s.points.pop_back();
  while (s.points[0].height == s.points[1].height) s.points.erase(s.points.begin());
  ExactOracle o;
  o.name = name, o.shape = {s};
  const std::size_t first = profile == Profile::linear ? 0 : 1;
  const long double lo = s.points[first].height, hi = s.points[s.points.size() - 1 - first].height;
  const auto ends = [lo, hi](const Vec3l& p) { return std::max(lo - p.y, p.y - hi); };
  const auto solid = [s, first](const Vec3l& p) {
    const long double rho = std::sqrt(p.x * p.x + p.z * p.z);
    long double d = HUGE_VALL;
    for (std::size_t k = first; k + 1 + first < s.points.size(); ++k) {
      // Where it is open, the first and the last piece have no end.
      const bool end = k == first || k + 2 + first == s.points.size();
      const bool past = p.y < s.points[first].height || p.y > s.points[s.points.size() - 1 - first].height;
      d = std::min(d, outside_piece(s, k, rho, p.y, !(s.open && end && past)));
    }
    return d;
  };
  o.f = solid;
  if (s.open) o.where = ends;
  o.lo = {-1.2, static_cast<double>(lo), -1.2}, o.hi = {1.2, static_cast<double>(hi), 1.2};
  return o;
}
ExactOracle spline(CaseRandom& random) {
  return revolution(random, "revolution", RevolutionShape::Profile::spline);
}
ExactOracle linear(CaseRandom& random) {
  return revolution(random, "revolution_linear", RevolutionShape::Profile::linear);
}
ExactOracle sor(CaseRandom& random) {
  return revolution(random, "revolution_sor", RevolutionShape::Profile::sor);
}

/// One coordinate of a Bezier piece at u.
template <class Real>
Real bezier(const Real (&p)[4], Real u) {
  const Real w = 1 - u;
  return p[0] * w * w * w + 3 * p[1] * w * w * u + 3 * p[2] * w * u * u + p[3] * u * u * u;
}

/// Calls f(u) where the piece has the value `at`, by safeguarded Newton on each part between its extremes.
template <class Real, class F>
void for_places(const Real (&p)[4], Real at, F&& f) {
  if (std::max({p[0], p[1], p[2], p[3]}) < at || std::min({p[0], p[1], p[2], p[3]}) > at) return;
  // Half the derivative's coefficients, in powers.
  const Real d0 = p[1] - p[0], d1 = p[2] - p[1], d2 = p[3] - p[2];
  const Real a = d0 - 2 * d1 + d2, b = d1 - d0, c = d0, disc = b * b - a * c;
  Real cuts[4] = {0};
  int n = 1;
  if (disc > 0) {
    const Real q = -(b + std::copysign(std::sqrt(disc), b));
    Real u = q / a, v = c / q;
    if (v < u) std::swap(u, v);
    if (u > 0 && u < 1) cuts[n++] = u;
    if (v > 0 && v < 1) cuts[n++] = v;
  }
  cuts[n] = 1;
  for (int i = 0; i < n; ++i) {
    Real lo = cuts[i], hi = cuts[i + 1];
    const bool rises = bezier(p, lo) < at;
    if (rises == (bezier(p, hi) < at)) continue;
    Real u = (lo + hi) / 2;
    for (int k = 0; k < 100; ++k) {
      const Real y = bezier(p, u) - at, w = 1 - u;
      ((y < 0) == rises ? lo : hi) = u;
      Real next = u - y / (3 * (d0 * w * w + 2 * d1 * w * u + d2 * u * u));
      if (!(next > lo && next < hi)) next = (lo + hi) / 2;
      if (std::abs(next - u) < std::numeric_limits<Real>::epsilon()) break;
      u = next;
    }
    f(u);
  }
}

template <class Real>
struct ProfileCurve {
  explicit ProfileCurve(const ProfilePoint* p) {
    for (int k = 0; k < 4; ++k) r[k] = p[k].radius, y[k] = p[k].height;
  }
  Real r[4], y[4];
};

/// About how far (rho, y) is from the profile, negative inside.
template <class Real>
Real outside_profile(const std::vector<ProfileCurve<Real>>& pieces, const std::array<ProfilePoint, 2>& ends,
                     bool loop, Real rho, Real y) {
  Real distance = 3;
  bool odd = false;
  for (const ProfileCurve<Real>& c : pieces) {
    for_places(c.y, y, [&](Real u) {
      const Real r = bezier(c.r, u);
      distance = std::min(distance, std::abs(r - rho)), odd ^= r > rho;
    });
    for_places(c.r, rho, [&](Real u) { distance = std::min(distance, std::abs(bezier(c.y, u) - y)); });
  }
  for (const ProfilePoint& end : ends)
    if (!loop && rho < end.radius) distance = std::min(distance, std::abs(static_cast<Real>(end.height) - y));
  return odd ? -distance : distance;
}

/// A point is inside if a level line outwards crosses the profile an odd number of times.
ExactOracle lathe(CaseRandom& random) {
  const auto about = [&](double x, double by) { return x + by * (2 * random.unit() - 1); };
  std::vector<ProfilePoint> points;
  const double kind = random.unit();
  LatheShape s;
  if (kind < 0.4) {
    // A vessel with an inner wall.
    for (const ProfilePoint& p : std::initializer_list<ProfilePoint>{{0, -1},
                                                                     {0.3, -0.8},
                                                                     {0.8, -0.3},
                                                                     {0.6, 0.4},
                                                                     {0.85, 0.9},
                                                                     {0.5, 0.6},
                                                                     {0.4, 0},
                                                                     {0.2, -0.4},
                                                                     {0, -0.4}})
      points.push_back({about(p.radius, 0.04), about(p.height, 0.04)});
    s.points = curve_through(points);
  } else if (kind < 0.7) {
    // A ring.
    const int n = 6 + static_cast<int>(random.unit() * 4);
    for (int i = 0; i < n; ++i) {
      const double r = 0.25 + 0.15 * random.unit(), angle = 6.283185307179586 * i / n;
      points.push_back({0.6 + r * std::cos(angle), r * std::sin(angle)});
    }
    for (int i = 0; i < 3; ++i) points.push_back(points[i]);
    s.points = curve_through(points);
    s.points.back() = s.points.front();
  } else {
    // Control points along the axis.
    const int n = 3 * (1 + static_cast<int>(random.unit() * 3));
    for (int i = 0; i <= n; ++i) s.points.push_back({about(0.6, 0.3), about(2.0 * i / n - 1, 0.1)});
    s.open = random.unit() < 0.3;
  }
  if (random.unit() < 0.5) std::reverse(s.points.begin(), s.points.end());
  if (!std::string(why_bad_profile(s)).empty()) return lathe(random);
  std::vector<ProfileCurve<double>> rough;
  std::vector<ProfileCurve<long double>> pieces;
  for (std::size_t i = 0; i + 3 < s.points.size(); i += 3) {
    rough.emplace_back(&s.points[i]);
    pieces.emplace_back(&s.points[i]);
  }
  const ProfilePoint ends[2] = {s.points.front(), s.points.back()};
  const bool loop = ends[0].radius == ends[1].radius && ends[0].height == ends[1].height;
  ExactOracle o;
  o.name = "lathe", o.shape = {s};
  // In `long double` where `double` might not tell the sign.
  o.f = [rough, pieces, ends = std::array{ends[0], ends[1]}, loop](const Vec3l& p) {
    const long double rho = std::sqrt(p.x * p.x + p.z * p.z);
    const double distance =
        outside_profile<double>(rough, ends, loop, static_cast<double>(rho), static_cast<double>(p.y));
    return std::abs(distance) > 0x1p-20 ? distance
                                        : outside_profile<long double>(pieces, ends, loop, rho, p.y);
  };
  // The disks at the ends are not there.
  if (s.open) {
    o.where = [ends = std::array{ends[0], ends[1]}](const Vec3l& p) {
      const long double rho = std::sqrt(p.x * p.x + p.z * p.z);
      long double d = -1;
      for (const ProfilePoint& end : ends)
        d = std::max(d, std::min(end.radius - rho, 1e-6L - std::abs(p.y - end.height)));
      return d;
    };
  }
  o.lo = o.hi = {0, s.points[0].height, 0};
  for (const ProfilePoint& p : s.points)
    o.lo = min(o.lo, Vec3d{-p.radius, p.height, -p.radius}),
    o.hi = max(o.hi, Vec3d{p.radius, p.height, p.radius});
  return o;
}

}  // namespace

std::vector<DrawExact> polynomial_oracles() {
  return {random_polynomial, even_powers, barth,  chmutov, blob, large_blob,
          endless_blob,      spline,      linear, sor,     lathe};
}

}  // namespace oktett
