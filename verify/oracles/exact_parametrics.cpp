/// \file Surfaces given by functions of two parameters, by equations in x, y and z that they fulfil.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernels/exact/parametric.h"
#include "verify/oracles/exact_families.h"

namespace oktett {
namespace {

constexpr double kPi = std::numbers::pi;

/// A function of u and v as a text and in C++, and an enclosure of it over a rectangle.
struct Ripple {
  std::string text;
  std::function<Real(Real, Real)> at;
  std::function<Enclosure(Enclosure, Enclosure)> over;
};
template <class F>
Ripple ripple(std::string text, const F& f) {
  return {std::move(text), f, f};
}

UvFunction compiled(const std::string& text) { return {compile_function(text, kSurfaceVariables)}; }

ParametricShape surface_of(const std::string& x, const std::string& y, const std::string& z) {
  ParametricShape s;
  s.x = compiled(x), s.y = compiled(y), s.z = compiled(z);
  return s;
}

/// Numbers as both forms have them.
double short_number(double x) { return std::round(x * 4096) / 4096; }

/// Waves over (u, v) of this height.
Ripple draw_ripple(CaseRandom& random, double high) {
  const double a = short_number(high * random.sign()), m = std::round(1 + 4 * random.unit()),
               n = std::round(1 + 4 * random.unit()), p = short_number(random.sign());
  using std::abs, std::cos, std::exp, std::sin, std::sqrt;
  switch (random.bits() % 4) {
    case 0:
      return ripple(fmt::format("{}*sin({}*u + {})*cos({}*v)", a, m, p, n),
                    [=](auto u, auto v) { return a * sin(m * u + p) * cos(n * v); });
    case 1:
      return ripple(fmt::format("{}*exp(-(u - {})^2 - v^2)", a, p),
                    [=](auto u, auto v) { return a * exp(-(u - p) * (u - p) - v * v); });
    case 2:
      return ripple(fmt::format("{}*(u^2 - v^2*u + {}*v)", a, p),
                    [=](auto u, auto v) { return a * (u * u - v * v * u + p * v); });
    default:
      return ripple(fmt::format("{}*abs(u - {}) + {}*sqrt(1 + v^2)", a, p, a),
                    [=](auto u, auto v) { return a * abs(u - p) + a * sqrt(1 + v * v); });
  }
}

/// Heights over a rectangle, in a box now and then.
ExactOracle graph(CaseRandom& random) {
  const Ripple h = draw_ripple(random, random.unit() < 0.1 ? 0 : random.magnitude(-2, 0));
  ParametricShape s = surface_of("u", "v", h.text);
  for (int k = 0; k < 2; ++k)
    s.from[k] = short_number(-1.5 * random.unit()), s.to[k] = short_number(0.1 + 1.5 * random.unit());
  s.cut = random.unit() < 0.3;
  s.lo = {-0.5, -0.6, -0.4}, s.hi = {0.7, 0.8, 0.3};
  ExactOracle o{{s}, [h](const Vec3l& p) { return p.z - h.at(p.x, p.y); }};
  double low = 1e9, high = -1e9;
  for (int k = 0; k <= 32 * 32; ++k) {
    const double u = s.from[0] + (s.to[0] - s.from[0]) * (k % 33) / 32,
                 v = s.from[1] + (s.to[1] - s.from[1]) * (k / 33) / 32;
    const auto z = static_cast<double>(h.at(u, v));
    low = std::min(low, z), high = std::max(high, z);
  }
  o.lo = {s.from[0], s.from[1], low - 0.1}, o.hi = {s.to[0], s.to[1], high + 0.1};
  o.where = [s](const Vec3l& p) {
    const Real beyond = std::max({s.from[0] - p.x, p.x - s.to[0], s.from[1] - p.y, p.y - s.to[1]});
    return s.cut ? std::max(beyond, outside(s.lo, s.hi, p)) : beyond;
  };
  o.clear = [s, h](const Vec3d& a, const Vec3d& b) {
    const Vec3<Enclosure> way = box_about(a, b);
    for (int k = 0; k < 2; ++k)
      if (way[k].hi < s.from[k] || way[k].lo > s.to[k]) return true;
    const Enclosure above = way.z - h.over(way.x, way.y);
    return above.positive() || above.negative();
  };
  return o;
}

/// A ball with bumps: longitude u and latitude v.
ExactOracle bumpy_ball(CaseRandom& random, bool open) {
  const double a = short_number(0.3 * random.unit()), b = short_number(0.2 * random.sign()),
               n = std::round(1 + 4 * random.unit());
  const std::string r = fmt::format("(1 + {}*cos(v)^3*sin({}*u) + {}*sin(3*v))", a, n, b);
  ParametricShape s = surface_of(r + "*cos(v)*cos(u)", r + "*cos(v)*sin(u)", r + "*sin(v)");
  s.open = open;
  s.from[0] = open ? 0.25 : -kPi, s.to[0] = open ? 5 : kPi;
  s.from[1] = open ? -1.25 : -kPi / 2, s.to[1] = open ? 1.125 : kPi / 2;
  const auto f = [=](const Vec3l& p) -> Real {
    const Real u = std::atan2(p.y, p.x), across = std::sqrt(p.x * p.x + p.y * p.y),
               v = std::atan2(p.z, across);
    const Real c = std::cos(v);
    return std::sqrt(dot(p, p)) - (1 + a * c * c * c * std::sin(n * u) + b * std::sin(3 * v));
  };
  ExactOracle o{{s}, f};
  o.grow({0, 0, 0}, 1.5);
  // The radius changes with v by 3 a + 3 |b| at most, and with u by a n cos(v), where circles are as short.
  o.clear = [f, steepest = (3 + n) * a + 3 * std::abs(b)](const Vec3d& from, const Vec3d& to) {
    const Vec3l middle = (Vec3l(from) + Vec3l(to)) * 0.5L;
    const Real room = 0.5L * length(to - from) + 1e-14L, nearest = std::sqrt(dot(middle, middle)) - room;
    return nearest > 0 && std::abs(f(middle)) > room * (1 + steepest / nearest);
  };
  if (open)
    o.where = [s](const Vec3l& p) -> Real {
      Real u = std::atan2(p.y, p.x);
      if (u < (s.from[0] + s.to[0]) / 2 - kPi) u += 2 * std::numbers::pi_v<Real>;
      const Real v = std::atan2(p.z, std::sqrt(p.x * p.x + p.y * p.y));
      return std::max({s.from[0] - u, u - s.to[0], s.from[1] - v, v - s.to[1]});
    };
  return o;
}

/// A ring whose tube is thicker here and there.
ExactOracle thick_ring(CaseRandom& random) {
  const double major = short_number(0.7 + 0.5 * random.unit()),
               minor = short_number(0.1 + 0.3 * random.unit()), a = short_number(0.5 * random.unit()),
               n = std::round(1 + 4 * random.unit());
  const std::string r = fmt::format("({} + {}*sin({}*u))", minor, short_number(a * minor), n);
  ParametricShape s = surface_of(fmt::format("({} + {}*cos(v))*cos(u)", major, r),
                                 fmt::format("({} + {}*cos(v))*sin(u)", major, r), r + "*sin(v)");
  s.open = false;
  s.from[0] = s.from[1] = 0, s.to[0] = s.to[1] = 2 * kPi;
  const Real wave = short_number(a * minor);
  const auto f = [=](const Vec3l& p) -> Real {
    const Real across = std::sqrt(p.x * p.x + p.y * p.y) - major;
    return std::sqrt(across * across + p.z * p.z) - (minor + wave * std::sin(n * std::atan2(p.y, p.x)));
  };
  const double out = major + 1.6 * minor;
  ExactOracle o{{s}, f, {-out, -out, -1.6 * minor}, {out, out, 1.6 * minor}};
  // Around the axis the tube's radius changes by n times the wave at most.
  o.clear = [f, steepest = n * std::abs(wave)](const Vec3d& from, const Vec3d& to) {
    const Vec3l middle = (Vec3l(from) + Vec3l(to)) * 0.5L;
    const Real room = 0.5L * length(to - from) + 1e-14L,
               nearest = std::sqrt(middle.x * middle.x + middle.y * middle.y) - room;
    return nearest > 0 && std::abs(f(middle)) > room * (1 + steepest / nearest);
  };
  return o;
}

}  // namespace

std::vector<ExactCase> parametric_cases() {
  return {{"parametric", graph},
          {"parametric_cap", [](CaseRandom& random) { return bumpy_ball(random, true); }},
          {"parametric_solid", [](CaseRandom& random) { return bumpy_ball(random, false); }},
          {"parametric_ring", thick_ring}};
}

}  // namespace oktett
