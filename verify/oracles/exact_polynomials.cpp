/// \file Polynomials, blobs of inverse squares and surfaces of revolution, from the equations of the sources.

#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/exact/lathe.h"
#include "kernels/exact/polynomial_expression.h"
#include "verify/oracles/curve_boxes.h"
#include "verify/oracles/exact_families.h"

namespace oktett {

namespace {

Real power(Real x, int n) {
  Real y = 1;
  for (; n > 0; --n) y *= x;
  return y;
}

ExactOracle polynomial(const std::string& equation, const SurfaceFunction& f, double r, bool open = false) {
  const Vec3d lo{-r, -r, -r}, hi{r, r, r};
  ExactOracle o{{PolynomialShape{expand_polynomial(equation), lo, hi, open}}, f};
  cut_by_box(o, lo, hi, open);
  return o;
}

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
  const Vec3d towards = random.vector();
  const Vec3d middle = towards * (random.unit() < 0.3 ? 3.0 : 0.3);
  const Vec3d half{0.4 + random.unit(), 0.4 + random.unit(), 0.4 + random.unit()};
  s.lo = middle - half, s.hi = middle + half;
  s.open = random.unit() < 0.5;
  return oracle_of(s);
}

/// x^n + y^n + z^n = 1 (Melcher).
ExactOracle even_powers(CaseRandom& random) {
  const int n = 2 + 2 * static_cast<int>(random.unit() * 6);
  const std::string k = std::to_string(n);
  return polynomial(
      "x^" + k + " + y^" + k + " = 1 - z^" + k,
      [n](const Vec3l& p) { return power(p.x, n) + power(p.y, n) + power(p.z, n) - 1; }, 1.1);
}

/// Barth's sextic, with 65 double points.
ExactOracle barth(CaseRandom&) {
  return polynomial(
      "4*((1+sqrt(5))^2/4*x^2-y^2)*((1+sqrt(5))^2/4*y^2-z^2)*((1+sqrt(5))^2/4*z^2-x^2)"
      " - (2+sqrt(5))*(x^2+y^2+z^2-1)^2",
      [](const Vec3l& p) {
        const Real phi = (1 + std::sqrt(5.0L)) / 2, q = phi * phi;
        const Real x = p.x * p.x, y = p.y * p.y, z = p.z * p.z, r = x + y + z - 1;
        return 4 * (q * x - y) * (q * y - z) * (q * z - x) - (1 + 2 * phi) * r * r;
      },
      1.7, true);
}

/// T_8(x) + T_8(y) + T_8(z) = 0 with Chebyshev's polynomials (Chmutov).
ExactOracle chmutov(CaseRandom&) {
  const auto t8 = [](const std::string& x) {
    return "128*" + x + "^8-256*" + x + "^6+160*" + x + "^4-32*" + x + "^2+1";
  };
  return polynomial(
      t8("x") + "+" + t8("y") + "+" + t8("z"),
      [](const Vec3l& p) {
        Real sum = 0;
        for (int k = 0; k < 3; ++k) {
          const Real a = 2 * p[k] * p[k] - 1, b = 2 * a * a - 1;
          sum += 2 * b * b - 1;
        }
        return sum;
      },
      1.05);
}

/// The potential of the sources of a blob.
Real potential(const BlobShape& s, const Vec3l& p) {
  Real sum = 0;
  for (const BlobSource& source : s.sources) {
    const Vec3l v{p.x - source.at.x, p.y - source.at.y, p.z - source.at.z};
    const Vec3l d{source.direction.x, source.direction.y, source.direction.z};
    Real q = dot(v, v);
    if (source.kind == BlobSource::Kind::line) {
      const Vec3l c = cross(v, d);
      q = dot(c, c) / dot(d, d);
    } else if (source.kind == BlobSource::Kind::plane) {
      const Real a = dot(p, d) / std::sqrt(dot(d, d)) - source.offset;
      q = a * a;
    }
    sum += source.weight / q;
  }
  return sum;
}

template <int kMost, bool kEndless>
ExactOracle blob(CaseRandom& random) {
  BlobShape s;
  const int count = 1 + static_cast<int>(random.unit() * kMost);
  for (int i = 0; i < count; ++i) {
    BlobSource source;
    source.at = random.vector();
    source.direction = random.vector();
    source.offset = 0.5 * random.vector().x;
    source.weight = i > 0 && random.unit() < 0.2 ? -0.3 * random.unit() : 0.1 + random.unit();
    if (kEndless && random.unit() < 0.6)
      source.kind = random.unit() < 0.5 ? BlobSource::Kind::line : BlobSource::Kind::plane;
    s.sources.push_back(source);
  }
  s.iso = count * (1 + 6 * random.unit());
  if (kEndless) {
    s.bounded = true, s.open = random.unit() < 0.3;
    s.lo = {-1.2, -1.2, -1.2}, s.hi = {1.2, 1.0, 1.4};
  }
  // About as even as a distance.
  ExactOracle o{{s}, [s](const Vec3l& p) {
                  return 1 / std::sqrt(std::max(potential(s, p), 0.01L * s.iso)) -
                         1 / std::sqrt(static_cast<Real>(s.iso));
                }};
  if (kEndless) {
    cut_by_box(o, s.lo, s.hi, s.open);
  } else {
    // No farther from a source than where all of them in one point would reach.
    double weight = 0;
    for (const BlobSource& source : s.sources) weight += std::max(source.weight, 0.0);
    for (const BlobSource& source : s.sources) o.grow(source.at, std::sqrt(weight / s.iso));
  }
  return o;
}

/// How far the points between two are from the axis y.
Enclosure distance_from_axis(const Vec3d& a, const Vec3d& b) {
  const double away = std::hypot((a.x + b.x) / 2, (a.z + b.z) / 2),
               room = std::hypot((b.x - a.x) / 2, (b.z - a.z) / 2);
  return max(Enclosure::between(away - room, away + room).with_room(1e-14 * (away + room)), 0);
}

/// How far outside of piece k of a profile: of its slab of height, or of its radius at that height by
/// Bezier's form, with i = y and j = 1 - y (Melcher), or straight, or for `sor` the square root of a cubic.
/// Numbers are `Real` or enclosures.
template <class T>
T outside_piece(const RevolutionShape& s, std::size_t k, T rho, T height, bool slab) {
  using std::max, std::min, std::sqrt;
  const ProfilePoint &p = s.points[k], &q = s.points[k + 1];
  const T h = T(q.height) - p.height, zero = 0, one = 1;
  if (!(p.height < q.height)) return HUGE_VALL;
  const T ends = slab ? max(p.height - height, height - q.height) : T(-HUGE_VALL);
  const T i = min(max((height - p.height) / h, zero), one), j = 1 - i;
  if (s.profile == RevolutionShape::Profile::linear) return max(ends, rho - (q.radius * i + p.radius * j));
  const auto slope = [&](std::size_t at) {
    const ProfilePoint &a = s.points[at - 1], &b = s.points[at + 1];
    return (T(b.radius) - a.radius) / (T(b.height) - a.height);
  };
  const T m = slope(k) * h / 3, n = slope(k + 1) * h / 3, r = p.radius, t = q.radius;
  if (s.profile == RevolutionShape::Profile::sor) {
    const T square = t * t * i * i * i + 3 * (t * t - 2 * t * n) * i * i * j +
                     3 * (r * r + 2 * r * m) * i * j * j + r * r * j * j * j;
    return max(ends, rho - sqrt(max(square, zero)));
  }
  return max(ends, rho - (t * i * i * i + 3 * (t - n) * i * i * j + 3 * (r + m) * i * j * j + r * j * j * j));
}

using Profile = RevolutionShape::Profile;

template <Profile kProfile>
ExactOracle revolution(CaseRandom& random) {
  RevolutionShape s;
  s.profile = kProfile, s.open = random.unit() < 0.3;
  const int count = 4 + static_cast<int>(random.unit() * 4);
  double y = random.vector().x;
  for (int i = 0; i < count; ++i) {
    const bool tip = kProfile == Profile::linear && random.unit() < 0.15;
    s.points.push_back({tip ? 0 : 0.45 + 0.4 * random.unit(), y});
    const bool ring = kProfile == Profile::linear && i > 0 && random.unit() < 0.2;
    y += ring ? 0 : 0.35 + 0.4 * random.unit();
  }
  while (s.points[s.points.size() - 2].height == s.points.back().height) s.points.pop_back();
  while (s.points[0].height == s.points[1].height) s.points.erase(s.points.begin());
  return oracle_of(s);
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
      constexpr Real kEnough = std::numeric_limits<Real>::epsilon();
      Real next = u - y / (3 * (d0 * w * w + 2 * d1 * w * u + d2 * u * u));
      if (!(std::abs(next - u) < kEnough) && !(next > lo && next < hi)) next = (lo + hi) / 2;
      if (std::abs(next - u) < kEnough) break;
      u = next;
    }
    f(u);
  }
}

/// Such a coordinate for the boxes of curves.
struct BezierNumber {
  const double (&p)[4];

  double at(double u) const { return bezier(p, u); }
  double slope(double u) const {
    const double w = 1 - u;
    return 3 * ((p[1] - p[0]) * w * w + 2 * (p[2] - p[1]) * w * u + (p[3] - p[2]) * u * u);
  }
};

template <class Real>
struct ProfileCurve {
  explicit ProfileCurve(const ProfilePoint* p) {
    for (int k = 0; k < 4; ++k) r[k] = p[k].radius, y[k] = p[k].height;
  }
  Real r[4], y[4];
};

/// What a point (rho, y) sees of a profile.
template <class Real>
struct ProfileView {
  Real wall = 3;     ///< about how far the curve is: the nearest along a level line or an upright one
  Real disk = 3;     ///< how far the disks are that close the ends
  bool odd = false;  ///< a level line outwards crosses the curve an odd number of times: inside
};

template <class Real>
ProfileView<Real> view_of_profile(const std::vector<ProfileCurve<Real>>& pieces,
                                  const std::array<ProfilePoint, 2>& ends, bool loop, Real rho, Real y) {
  ProfileView<Real> view;
  for (const ProfileCurve<Real>& c : pieces) {
    for_places(c.y, y, [&](Real u) {
      const Real r = bezier(c.r, u);
      view.wall = std::min(view.wall, std::abs(r - rho)), view.odd ^= r > rho;
    });
    for_places(c.r, rho, [&](Real u) { view.wall = std::min(view.wall, std::abs(bezier(c.y, u) - y)); });
  }
  if (loop) return view;
  for (const ProfilePoint& end : ends) {
    const Real beyond = rho - static_cast<Real>(end.radius), height = y - static_cast<Real>(end.height);
    view.wall = std::min(view.wall, std::hypot(beyond, height));
    view.disk = std::min(view.disk, std::hypot(std::max(beyond, Real(0)), height));
  }
  return view;
}

/// A point is inside if a level line outwards crosses the profile an odd number of times.
ExactOracle lathe(CaseRandom& random) {
  const auto about = [&](double x, double by) { return x + by * (2 * random.unit() - 1); };
  std::vector<ProfilePoint> points;
  const double kind = random.unit();
  LatheShape s;
  if (kind < 0.4) {
    // A vessel with an inner wall.
    constexpr ProfilePoint kVessel[] = {{0, -1},    {0.3, -0.8}, {0.8, -0.3}, {0.6, 0.4}, {0.85, 0.9},
                                        {0.5, 0.6}, {0.4, 0},    {0.2, -0.4}, {0, -0.4}};
    for (const ProfilePoint& p : kVessel) points.push_back({about(p.radius, 0.04), about(p.height, 0.04)});
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
  std::vector<ProfileCurve<Real>> pieces;
  for (std::size_t i = 0; i + 3 < s.points.size(); i += 3) {
    rough.emplace_back(&s.points[i]);
    pieces.emplace_back(&s.points[i]);
  }
  const std::array ends{s.points.front(), s.points.back()};
  const bool loop = ends[0].radius == ends[1].radius && ends[0].height == ends[1].height;
  ExactOracle o{{s}, {}};
  // In `Real` where `double` might not tell the sign.
  o.f = [rough, pieces, ends, loop](const Vec3l& p) {
    const Real rho = std::sqrt(p.x * p.x + p.z * p.z);
    const auto outside = [](const auto& view) {
      const auto distance = std::min(view.wall, view.disk);
      return view.odd ? -distance : distance;
    };
    const double distance = outside(
        view_of_profile<double>(rough, ends, loop, static_cast<double>(rho), static_cast<double>(p.y)));
    return std::abs(distance) > 0x1p-20 ? distance
                                        : outside(view_of_profile<Real>(pieces, ends, loop, rho, p.y));
  };
  // The disks at the ends are not there: what is nearer to them than to the curve is no surface.
  if (s.open) {
    o.where = [pieces, ends, loop](const Vec3l& p) {
      const auto view = view_of_profile<Real>(pieces, ends, loop, std::sqrt(p.x * p.x + p.z * p.z), p.y);
      return view.wall - view.disk;
    };
  }
  CurveBoxes curves;
  for (const ProfileCurve<double>& c : rough) curves.add(BezierNumber{c.r}, BezierNumber{c.y});
  // Where neither the curve nor a disk is, the number of crossings stays the same.
  o.clear = [curves, ends, loop](const Vec3d& a, const Vec3d& b) {
    const Enclosure y = box_about(a, b).y, rho = distance_from_axis(a, b);
    for (const ProfilePoint& end : ends)
      if (!loop && rho.lo <= end.radius && y.lo <= end.height && y.hi >= end.height) return false;
    return !curves.meet(rho, y);
  };
  for (const ProfilePoint& p : s.points)
    o.lo = min(o.lo, Vec3d{-p.radius, p.height, -p.radius}),
    o.hi = max(o.hi, Vec3d{p.radius, p.height, p.radius});
  return o;
}

}  // namespace

ExactOracle oracle_of(const PolynomialShape& s) {
  ExactOracle o{{s}, [terms = s.terms](const Vec3l& p) {
                  Real sum = 0;
                  for (const Monomial& m : terms)
                    sum += m.c * power(p.x, m.i) * power(p.y, m.j) * power(p.z, m.k);
                  return sum;
                }};
  cut_by_box(o, s.lo, s.hi, s.open);
  return o;
}

ExactOracle oracle_of(const RevolutionShape& s) {
  // Splines have a control point beyond each end.
  const std::size_t first = s.profile == Profile::linear ? 0 : 1, last = s.points.size() - 1 - first;
  const double lo = s.points[first].height, hi = s.points[last].height;
  const auto solid = [=](const Vec3l& p) {
    const Real rho = std::sqrt(p.x * p.x + p.z * p.z);
    Real d = HUGE_VALL;
    for (std::size_t k = first; k < last; ++k) {
      // Where it is open, the first and the last piece have no end.
      const bool end = k == first || k + 1 == last, past = p.y < lo || p.y > hi;
      d = std::min(d, outside_piece(s, k, rho, p.y, !(s.open && end && past)));
    }
    return d;
  };
  ExactOracle o{{s}, solid, {-1.2, lo, -1.2}, {1.2, hi, 1.2}};
  o.clear = [=](const Vec3d& a, const Vec3d& b) {
    const Enclosure height = box_about(a, b).y;
    if (height.hi < lo || height.lo > hi) return true;
    if (s.open && (height.lo <= lo || height.hi >= hi)) return false;
    const Enclosure rho = distance_from_axis(a, b);
    bool outside = true;
    for (std::size_t k = first; k < last; ++k) {
      if (height.hi < s.points[k].height || height.lo > s.points[k + 1].height) continue;
      const Enclosure one = outside_piece(s, k, rho, height, true);
      if (one.negative()) return true;
      outside &= one.positive();
    }
    return outside;
  };
  if (s.open) o.where = [lo, hi](const Vec3l& p) { return std::max(lo - p.y, p.y - hi); };
  return o;
}

std::vector<ExactCase> polynomial_cases() {
  return {{"polynomial", random_polynomial},
          {"polynomial_even", even_powers},
          {"polynomial_barth", barth},
          {"polynomial_chmutov", chmutov},
          {"blob", blob<4, false>},
          {"blob_large", blob<16, false>},
          {"blob_endless", blob<4, true>},
          {"revolution", revolution<Profile::spline>},
          {"revolution_linear", revolution<Profile::linear>},
          {"revolution_sor", revolution<Profile::sor>},
          {"lathe", lathe}};
}

}  // namespace oktett
