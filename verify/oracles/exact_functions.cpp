/// \file Functions of the user's own: surfaces known by name, written out by hand, and random expressions
/// that are evaluated as they are drawn. Most are written for numbers of any kind, so that they have
/// enclosures.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kernels/functions/function_tape.h"
#include "verify/oracles/exact_families.h"
#include "verify/oracles/exact_noise.h"

namespace oktett {

namespace {

using std::abs, std::cos, std::exp, std::log, std::max, std::min, std::pow, std::sin, std::sqrt;
using EnclosingFunction = std::function<Enclosure(const Vec3<Enclosure>&)>;

/// A text and what it means.
struct Named {
  std::string text;
  SurfaceFunction f;
  double size;                       ///< half the side of the box
  EnclosingFunction enclosing = {};  ///< if set, of f over a box
};

/// One whose function takes numbers of any kind.
template <class F>
Named general(std::string text, double size, const F& f) {
  return {std::move(text), [f](const Vec3l& p) -> Real { return f(p); }, size,
          [f](const Vec3<Enclosure>& p) -> Enclosure { return f(p); }};
}

ExactOracle oracle(const Named& named, bool open) {
  const Vec3d hi{named.size, named.size, named.size};
  ImplicitShape s;
  s.function = compile_function(named.text);
  s.lo = -hi, s.hi = hi, s.open = open;
  // Where the function is not defined is outside.
  ExactOracle o{{s}, [f = named.f](const Vec3l& p) {
                  const Real v = f(p);
                  return std::isnan(v) ? 1 : v;
                }};
  if (named.enclosing) o.clear = clear_by(named.enclosing);
  cut_by_box(o, s.lo, s.hi, open);
  return o;
}

/// A number as an expression reads it.
std::string text(double v) { return fmt::format("({:.17g})", v); }

Real square(Real v) { return v * v; }

template <class T>
T diagonal(const T& v, const T& w) {
  return sqrt(square(v) + square(w));
}

std::vector<Named> periodic(CaseRandom& random) {
  const double c = random.sign(), k = 1 + 6 * random.unit();
  return {
      general("sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x) - " + text(0.5 * c), 6,
              [c](const auto& p) {
                return sin(p.x) * cos(p.y) + sin(p.y) * cos(p.z) + sin(p.z) * cos(p.x) - 0.5L * c;
              }),
      general("cos(" + text(k) + "*x) + cos(" + text(k) + "*y) + cos(" + text(k) + "*z) - " + text(c), 2,
              [c, k](const auto& p) { return cos(k * p.x) + cos(k * p.y) + cos(k * p.z) - c; }),
      general("y - 0.3*sin(" + text(k) + "*x)*cos(" + text(k) + "*z)", 1,
              [k](const auto& p) { return p.y - 0.3L * sin(k * p.x) * cos(k * p.z); }),
      general("y - 0.3*cos(" + text(2 * k) + "*hypot(x, z))*exp(-(x^2+z^2))", 1.5,
              [k](const auto& p) {
                const auto q = square(p.x) + square(p.z);
                return p.y - 0.3L * cos(2 * k * sqrt(q)) * exp(-q);
              }),
      general("sin(x*y) + sin(y*z) + sin(z*x) - " + text(c), 3,
              [c](const auto& p) { return sin(p.x * p.y) + sin(p.y * p.z) + sin(p.z * p.x) - c; }),
      // Twisted by the angle around the axis.
      {"sqrt((hypot(x, y) - 1)^2 + z^2) - 0.3 - 0.1*sin(3*atan2(y, x) + 2*atan2(z, hypot(x, y) - 1))",
       [](const Vec3l& p) {
         const Real r = std::sqrt(p.x * p.x + p.y * p.y) - 1;
         return std::sqrt(r * r + p.z * p.z) - 0.3L -
                0.1L * std::sin(3 * std::atan2(p.y, p.x) + 2 * std::atan2(p.z, r));
       },
       1.5},
  };
}

std::vector<Named> algebraic(CaseRandom& random) {
  const double c = random.sign();
  return {
      general("x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8 + " + text(c), 3,
              [c](const auto& p) {
                auto sum = 0 * p.x + (11.8L + c);
                for (int k = 0; k < 3; ++k) sum += square(p[k]) * (square(p[k]) - 5);
                return sum;
              }),
      general("(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3", 1.5,
              [](const auto& p) {
                const auto a = square(p.x) + 2.25L * square(p.y) + square(p.z) - 1, b = p.z * square(p.z);
                return a * square(a) - square(p.x) * b - 9.0L / 80 * square(p.y) * b;
              }),
      general("((x^2+y^2-0.64)^2+(z^2-1)^2)*((y^2+z^2-0.64)^2+(x^2-1)^2)*((z^2+x^2-0.64)^2+(y^2-1)^2) - 0.02",
              1.3,
              [](const auto& p) {
                const auto x = square(p.x), y = square(p.y), z = square(p.z);
                return (square(x + y - 0.64L) + square(z - 1)) * (square(y + z - 0.64L) + square(x - 1)) *
                           (square(z + x - 0.64L) + square(y - 1)) -
                       0.02L;
              }),
      // Klein's bottle.
      general("(x^2+y^2+z^2+2*y-1)*((x^2+y^2+z^2-2*y-1)^2-8*z^2)+16*x*z*(x^2+y^2+z^2-2*y-1)", 4,
              [](const auto& p) {
                const auto r = square(p.x) + square(p.y) + square(p.z), a = r - 2 * p.y - 1;
                return (r + 2 * p.y - 1) * (square(a) - 8 * square(p.z)) + 16 * p.x * p.z * a;
              }),
      general("sqrt((sqrt(x^2 + y^2) - 0.7)^2 + z^2) - 0.25", 1,
              [](const auto& p) { return diagonal(diagonal(p.x, p.y) - 0.7L, p.z) - 0.25L; }),
      general("abs(x)^2.5 + abs(y)^2.5 + abs(z)^1.3 - 1", 1.1,
              [](const auto& p) { return pow(abs(p.x), 2.5) + pow(abs(p.y), 2.5) + pow(abs(p.z), 1.3) - 1; }),
      {"x^2 + z^2/(1 + y^2) - 0.5*2^y/(1 + 3^(-y))",
       [](const Vec3l& p) {
         return p.x * p.x + p.z * p.z / (1 + p.y * p.y) -
                0.5L * std::pow(2.0L, p.y) / (1 + std::pow(3.0L, -p.y));
       },
       1.5},
  };
}

std::vector<Named> combined(CaseRandom& random) {
  const double c = random.sign();
  const auto blob = [](const auto& x, const auto& y, const auto& z) {
    return exp(-3 * (square(x) + square(y) + square(z)));
  };
  return {
      general("0.5 - exp(-3*((x-0.5)^2+y^2+z^2)) - exp(-3*((x+0.5)^2+(y-" + text(c) + ")^2+z^2))", 2,
              [c, blob](const auto& p) {
                return 0.5L - blob(p.x - 0.5L, p.y, p.z) - blob(p.x + 0.5L, p.y - c, p.z);
              }),
      general("max(abs(x) - 0.8, abs(y) - 0.8, abs(z) - 0.8, 1 - sqrt(x^2 + y^2 + z^2))", 1,
              [](const auto& p) {
                return max(max(abs(p.x), max(abs(p.y), abs(p.z))) - static_cast<Real>(0.8),
                           1 - diagonal(p.x, diagonal(p.y, p.z)));
              }),
      general("min(x^2 + y^2 + z^2 - 0.5, max(hypot(x, z) - 0.2, abs(y) - 0.9), hypot(y, z) - 0.15)", 1,
              [](const auto& p) {
                return min(min(square(p.x) + square(p.y) + square(p.z) - 0.5L,
                               max(diagonal(p.x, p.z) - 0.2L, abs(p.y) - 0.9L)),
                           diagonal(p.y, p.z) - 0.15L);
              }),
      general("-log(0.1 + 0.3/(0.05 + (x-0.4)^2 + y^2 + z^2) + 0.3/(0.05 + (x+0.4)^2 + y^2 + z^2)) + 0.5",
              1.5,
              [](const auto& p) {
                const auto at = [&](Real d) {
                  return 0.3L / (0.05L + square(p.x + d) + square(p.y) + square(p.z));
                };
                return 0.5L - log(0.1L + at(-0.4L) + at(0.4L));
              }),
      {"atan(4*y) - asin(x/3) + acos(z/3) - 1.5 + 0.2*tan(x/2)",
       [](const Vec3l& p) {
         return std::atan(4 * p.y) - std::asin(p.x / 3) + std::acos(p.z / 3) - 1.5L +
                0.2L * std::tan(p.x / 2);
       },
       2},
      {"x^2 + y^2 + z^2 - 1 + 0.4*noise(" + text(3 * c) + "*x, 2*y + 0.3, 2*z)",
       [c](const Vec3l& p) {
         return dot(p, p) - 1 + 0.4L * exact_noise(3 * c * p.x, 2 * p.y + 0.3L, 2 * p.z);
       },
       1.5},
      {"y - 0.3*noise(2*x, 0, 2*z) - 0.1*abs(noise(5*x, 5*y, 5*z))",
       [](const Vec3l& p) {
         return p.y - 0.3L * exact_noise(2 * p.x, 0, 2 * p.z) -
                0.1L * std::abs(exact_noise(5 * p.x, 5 * p.y, 5 * p.z));
       },
       1.5},
      // As POV-Ray's second generator has it, and rough ground of the sum itself.
      {"x^2 + y^2 + z^2 - 0.7 - 0.8*max(0, min(1, 0.48985582*(1.05242 + povray_noise(" + text(3 * c) +
           "*x, 3*y, 3*z))))",
       [c](const Vec3l& p) {
         const Real noise = 0.48985582L * (1.05242L + exact_povray_noise(3 * c * p.x, 3 * p.y, 3 * p.z));
         return dot(p, p) - 0.7L - 0.8L * std::max(Real{0}, std::min(Real{1}, noise));
       },
       1.5},
      {"y - 0.5*povray_noise(2*x, 0, 2*z) - 0.1*abs(povray_noise(5*x, 5*y, 5*z))",
       [](const Vec3l& p) {
         return p.y - 0.5L * exact_povray_noise(2 * p.x, 0, 2 * p.z) -
                0.1L * std::abs(exact_povray_noise(5 * p.x, 5 * p.y, 5 * p.z));
       },
       1.5},
      general("abs(abs(abs(x) - 0.5) - 0.2) + abs(y) + abs(abs(z) - 0.4) - 0.3", 1,
              [](const auto& p) {
                return abs(abs(abs(p.x) - 0.5L) - 0.2L) + abs(p.y) + abs(abs(p.z) - 0.4L) - 0.3L;
              }),
  };
}

/// Not defined everywhere, with poles, or with steps; none of these in a face of the box, which would leave a
/// sheet without thickness there.
std::vector<Named> torn(CaseRandom&) {
  return {
      {"sqrt(x) + y^2 + z^2 - 0.6",
       [](const Vec3l& p) { return std::sqrt(p.x) + p.y * p.y + p.z * p.z - 0.6L; }, 1},
      {"log(x^2 + y) + z", [](const Vec3l& p) { return std::log(p.x * p.x + p.y) + p.z; }, 1.5},
      {"1/x + 1/y + z", [](const Vec3l& p) { return 1 / p.x + 1 / p.y + p.z; }, 2},
      {"y - tan(x)*z", [](const Vec3l& p) { return p.y - std::tan(p.x) * p.z; }, 3},
      {"y - 0.2*floor(4*x) - 0.1*sign(z)",
       [](const Vec3l& p) {
         return p.y - 0.2L * std::floor(4 * p.x) - 0.1L * (p.z > 0 ? 1 : p.z < 0 ? -1 : 0);
       },
       0.85},
      {"asin(x^2 + y^2) - 1 + z^2",
       [](const Vec3l& p) { return std::asin(p.x * p.x + p.y * p.y) - 1 + p.z * p.z; }, 1.2},
      {"y - x^z*0.5",
       [](const Vec3l& p) { return p.y - (p.x > 0 ? std::pow(p.x, p.z) : std::nan("")) * 0.5L; }, 1},
      {"x^-2 + y^-2 + z - 9", [](const Vec3l& p) { return 1 / (p.x * p.x) + 1 / (p.y * p.y) + p.z - 9; }, 1},
  };
}

/// What an expression is made of: functions of one or two numbers, of any kind.
struct Unary {
  template <class F>
  constexpr Unary(const char* first, const char* last, F function)
      : before(first), after(last), f(function), enclosing(function) {}
  const char *before, *after;
  Real (*f)(Real);
  Enclosure (*enclosing)(Enclosure);
};
constexpr Unary kUnary[] = {{"sin(2*(", "))", [](auto v) { return sin(2 * v); }},
                            {"cos(", ")", [](auto v) { return cos(v); }},
                            {"exp(-(", ")^2)", [](auto v) { return exp(-square(v)); }},
                            {"sqrt(1+(", ")^2)", [](auto v) { return sqrt(1 + square(v)); }},
                            {"abs(", ")", [](auto v) { return abs(v); }},
                            {"(", ")^3", [](auto v) { return v * square(v); }}};

struct Binary {
  template <class F>
  constexpr Binary(const char* first, const char* middle, F function)
      : before(first), between(middle), f(function), enclosing(function) {}
  const char *before, *between;
  Real (*f)(Real, Real);
  Enclosure (*enclosing)(Enclosure, Enclosure);
};
constexpr Binary kBinary[] = {{"(", "-", [](auto v, auto w) { return v - w; }},
                              {"(", "*", [](auto v, auto w) { return v * w; }},
                              {"(", "*", [](auto v, auto w) { return v * w; }},
                              {"max(", ",", [](auto v, auto w) { return max(v, w); }},
                              {"min(", ",", [](auto v, auto w) { return min(v, w); }},
                              {"(", "+", [](auto v, auto w) { return v + w; }}};

/// A random expression, smooth or with kinks.
Named draw(CaseRandom& random, int depth) {
  const auto pick = [&](int n) { return static_cast<int>(random.unit() * n); };
  if (depth == 0 || random.unit() < 0.1) {
    const int k = pick(4);
    if (k < 3) return general(std::string(1, "xyz"[k]), 1, [k](const auto& p) { return p[k]; });
    const double c = 2 * random.sign();
    return general(text(c), 1, [c](const auto&) { return c; });
  }
  const Named a = draw(random, depth - 1);
  if (random.unit() < 0.4) {
    const Unary& of = kUnary[pick(6)];
    return {of.before + a.text + of.after, [f = of.f, g = a.f](const Vec3l& p) { return f(g(p)); }, 1,
            [f = of.enclosing, g = a.enclosing](const Vec3<Enclosure>& p) { return f(g(p)); }};
  }
  const Named b = draw(random, depth - 1);
  const Binary& of = kBinary[pick(6)];
  return {of.before + a.text + of.between + b.text + ")",
          [f = of.f, g = a.f, h = b.f](const Vec3l& p) { return f(g(p), h(p)); }, 1,
          [f = of.enclosing, g = a.enclosing, h = b.enclosing](const Vec3<Enclosure>& p) {
            return f(g(p), h(p));
          }};
}

template <std::vector<Named> (*kAll)(CaseRandom&)>
ExactOracle one_of(CaseRandom& random) {
  const std::vector<Named> all = kAll(random);
  const auto k = static_cast<std::size_t>(random.unit() * static_cast<double>(all.size()));
  return oracle(all[k], random.unit() < 0.4);
}

ExactOracle draw_random(CaseRandom& random) {
  // Around a sphere, so that there is something to see.
  const Named e = draw(random, 3);
  const double size = 1 + random.unit();
  return oracle({"x^2 + y^2 + z^2 - 1 + 0.5*(" + e.text + ")",
                 [f = e.f](const Vec3l& p) { return dot(p, p) - 1 + 0.5L * f(p); }, size,
                 [f = e.enclosing](const Vec3<Enclosure>& p) {
                   return square(p.x) + square(p.y) + square(p.z) - 1 + 0.5L * f(p);
                 }},
                random.unit() < 0.4);
}

}  // namespace

std::vector<ExactCase> function_cases() {
  return {{"implicit", draw_random},
          {"implicit_periodic", one_of<periodic>},
          {"implicit_algebraic", one_of<algebraic>},
          {"implicit_combined", one_of<combined>},
          {"implicit_torn", one_of<torn>}};
}

}  // namespace oktett
