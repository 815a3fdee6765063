/// \file Functions of the user's own: surfaces known by name, written out by hand, and random expressions
/// that are evaluated as they are drawn.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kernels/functions/function_tape.h"
#include "verify/oracles/exact_families.h"
#include "verify/oracles/exact_noise.h"

namespace oktett {

namespace {

/// A text and what it means.
struct Named {
  std::string text;
  SurfaceFunction f;
  double size;  ///< half the side of the box
};

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
  cut_by_box(o, s.lo, s.hi, open);
  return o;
}

/// A number as an expression reads it.
std::string text(double v) { return fmt::format("({:.17g})", v); }

Real square(Real v) { return v * v; }

std::vector<Named> periodic(CaseRandom& random) {
  const double c = random.sign(), k = 1 + 6 * random.unit();
  return {
      {"sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x) - " + text(0.5 * c),
       [c](const Vec3l& p) {
         return std::sin(p.x) * std::cos(p.y) + std::sin(p.y) * std::cos(p.z) +
                std::sin(p.z) * std::cos(p.x) - 0.5L * c;
       },
       6},
      {"cos(" + text(k) + "*x) + cos(" + text(k) + "*y) + cos(" + text(k) + "*z) - " + text(c),
       [c, k](const Vec3l& p) { return std::cos(k * p.x) + std::cos(k * p.y) + std::cos(k * p.z) - c; }, 2},
      {"y - 0.3*sin(" + text(k) + "*x)*cos(" + text(k) + "*z)",
       [k](const Vec3l& p) { return p.y - 0.3L * std::sin(k * p.x) * std::cos(k * p.z); }, 1},
      {"y - 0.3*cos(" + text(2 * k) + "*hypot(x, z))*exp(-(x^2+z^2))",
       [k](const Vec3l& p) {
         const Real q = p.x * p.x + p.z * p.z;
         return p.y - 0.3L * std::cos(2 * k * std::sqrt(q)) * std::exp(-q);
       },
       1.5},
      {"sin(x*y) + sin(y*z) + sin(z*x) - " + text(c),
       [c](const Vec3l& p) { return std::sin(p.x * p.y) + std::sin(p.y * p.z) + std::sin(p.z * p.x) - c; },
       3},
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
      {"x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8 + " + text(c),
       [c](const Vec3l& p) {
         Real sum = 11.8L + c;
         for (int k = 0; k < 3; ++k) sum += p[k] * p[k] * (p[k] * p[k] - 5);
         return sum;
       },
       3},
      {"(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3",
       [](const Vec3l& p) {
         const Real a = p.x * p.x + 2.25L * p.y * p.y + p.z * p.z - 1, b = p.z * p.z * p.z;
         return a * a * a - p.x * p.x * b - 9.0L / 80 * p.y * p.y * b;
       },
       1.5},
      {"((x^2+y^2-0.64)^2+(z^2-1)^2)*((y^2+z^2-0.64)^2+(x^2-1)^2)*((z^2+x^2-0.64)^2+(y^2-1)^2) - 0.02",
       [](const Vec3l& p) {
         const Real x = p.x * p.x, y = p.y * p.y, z = p.z * p.z;
         return (square(x + y - 0.64L) + square(z - 1)) * (square(y + z - 0.64L) + square(x - 1)) *
                    (square(z + x - 0.64L) + square(y - 1)) -
                0.02L;
       },
       1.3},
      // Klein's bottle.
      {"(x^2+y^2+z^2+2*y-1)*((x^2+y^2+z^2-2*y-1)^2-8*z^2)+16*x*z*(x^2+y^2+z^2-2*y-1)",
       [](const Vec3l& p) {
         const Real r = dot(p, p), a = r - 2 * p.y - 1;
         return (r + 2 * p.y - 1) * (square(a) - 8 * p.z * p.z) + 16 * p.x * p.z * a;
       },
       4},
      {"sqrt((sqrt(x^2 + y^2) - 0.7)^2 + z^2) - 0.25",
       [](const Vec3l& p) {
         return std::sqrt(square(std::sqrt(p.x * p.x + p.y * p.y) - 0.7L) + p.z * p.z) - 0.25L;
       },
       1},
      {"abs(x)^2.5 + abs(y)^2.5 + abs(z)^1.3 - 1",
       [](const Vec3l& p) {
         return std::pow(std::abs(p.x), 2.5L) + std::pow(std::abs(p.y), 2.5L) +
                std::pow(std::abs(p.z), static_cast<Real>(1.3)) - 1;
       },
       1.1},
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
  const auto blob = [](Real x, Real y, Real z) { return std::exp(-3 * (x * x + y * y + z * z)); };
  return {
      {"0.5 - exp(-3*((x-0.5)^2+y^2+z^2)) - exp(-3*((x+0.5)^2+(y-" + text(c) + ")^2+z^2))",
       [c, blob](const Vec3l& p) {
         return 0.5L - blob(p.x - 0.5L, p.y, p.z) - blob(p.x + 0.5L, p.y - c, p.z);
       },
       2},
      {"max(abs(x) - 0.8, abs(y) - 0.8, abs(z) - 0.8, 1 - sqrt(x^2 + y^2 + z^2))",
       [](const Vec3l& p) {
         return std::max({std::abs(p.x) - static_cast<Real>(0.8), std::abs(p.y) - static_cast<Real>(0.8),
                          std::abs(p.z) - static_cast<Real>(0.8), 1 - std::sqrt(dot(p, p))});
       },
       1},
      {"min(x^2 + y^2 + z^2 - 0.5, max(hypot(x, z) - 0.2, abs(y) - 0.9), hypot(y, z) - 0.15)",
       [](const Vec3l& p) {
         return std::min({dot(p, p) - 0.5L,
                          std::max(std::sqrt(p.x * p.x + p.z * p.z) - 0.2L, std::abs(p.y) - 0.9L),
                          std::sqrt(p.y * p.y + p.z * p.z) - 0.15L});
       },
       1},
      {"-log(0.1 + 0.3/(0.05 + (x-0.4)^2 + y^2 + z^2) + 0.3/(0.05 + (x+0.4)^2 + y^2 + z^2)) + 0.5",
       [](const Vec3l& p) {
         const auto at = [&](Real d) {
           return 0.3L / (0.05L + (p.x + d) * (p.x + d) + p.y * p.y + p.z * p.z);
         };
         return 0.5L - std::log(0.1L + at(-0.4L) + at(0.4L));
       },
       1.5},
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
      {"abs(abs(abs(x) - 0.5) - 0.2) + abs(y) + abs(abs(z) - 0.4) - 0.3",
       [](const Vec3l& p) {
         return std::abs(std::abs(std::abs(p.x) - 0.5L) - 0.2L) + std::abs(p.y) +
                std::abs(std::abs(p.z) - 0.4L) - 0.3L;
       },
       1},
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

/// A random expression, smooth or with kinks.
Named draw(CaseRandom& random, int depth) {
  const auto pick = [&](int n) { return static_cast<int>(random.unit() * n); };
  if (depth == 0 || random.unit() < 0.1) {
    const int k = pick(4);
    if (k < 3) return {std::string(1, "xyz"[k]), [k](const Vec3l& p) { return p[k]; }, 1};
    const double c = 2 * random.sign();
    return {text(c), [c](const Vec3l&) { return static_cast<Real>(c); }, 1};
  }
  const Named a = draw(random, depth - 1);
  if (random.unit() < 0.4) {
    static constexpr struct {
      const char *before, *after;
      Real (*f)(Real);
    } kUnary[] = {{"sin(2*(", "))", [](Real v) { return std::sin(2 * v); }},
                  {"cos(", ")", [](Real v) { return std::cos(v); }},
                  {"exp(-(", ")^2)", [](Real v) { return std::exp(-v * v); }},
                  {"sqrt(1+(", ")^2)", [](Real v) { return std::sqrt(1 + v * v); }},
                  {"abs(", ")", [](Real v) { return std::abs(v); }},
                  {"(", ")^3", [](Real v) { return v * v * v; }}};
    const auto& [before, after, f] = kUnary[pick(6)];
    return {before + a.text + after, [of = f, g = a.f](const Vec3l& p) { return of(g(p)); }, 1};
  }
  const Named b = draw(random, depth - 1);
  static constexpr struct {
    const char *before, *between;
    Real (*f)(Real, Real);
  } kBinary[] = {{"(", "-", [](Real v, Real w) { return v - w; }},
                 {"(", "*", [](Real v, Real w) { return v * w; }},
                 {"(", "*", [](Real v, Real w) { return v * w; }},
                 {"max(", ",", [](Real v, Real w) { return std::max(v, w); }},
                 {"min(", ",", [](Real v, Real w) { return std::min(v, w); }},
                 {"(", "+", [](Real v, Real w) { return v + w; }}};
  const auto& [before, between, f] = kBinary[pick(6)];
  return {before + a.text + between + b.text + ")",
          [of = f, g = a.f, h = b.f](const Vec3l& p) { return of(g(p), h(p)); }, 1};
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
                 [f = e.f](const Vec3l& p) { return dot(p, p) - 1 + 0.5L * f(p); }, size},
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
