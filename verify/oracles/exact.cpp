#include "verify/oracles/exact.h"

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "verify/cases/random_parameters.h"
#include "verify/oracles/exact_families.h"

namespace oktett {

Vec3l mapped(const Affine& m, const Vec3l& p, Real one) {
  Vec3l q;
  for (int k = 0; k < 3; ++k) q[k] = m.m[k][0] * p.x + m.m[k][1] * p.y + m.m[k][2] * p.z + m.m[k][3] * one;
  return q;
}

void ExactOracle::grow(const Vec3d& center, double radius) {
  const Vec3d by{radius, radius, radius};
  lo = min(lo, center - by), hi = max(hi, center + by);
}

Real outside(const Vec3d& lo, const Vec3d& hi, const Vec3l& p) {
  Real d = -HUGE_VALL;
  for (int k = 0; k < 3; ++k) d = std::max({d, lo[k] - p[k], p[k] - hi[k]});
  return d;
}

void cut(ExactOracle& oracle, const SurfaceFunction& where, bool open) {
  oracle.clear = {};
  if (open)
    oracle.where = where;
  else
    oracle.f = [f = oracle.f, where](const Vec3l& p) { return std::max(f(p), where(p)); };
}

void cut_by_box(ExactOracle& oracle, const Vec3d& lo, const Vec3d& hi, bool open) {
  const auto beyond = [lo, hi](const Vec3l& p) { return outside(lo, hi, p); };
  ClearWay clear;
  if (oracle.clear)
    clear = [lo, hi, open, f = oracle.f, uncut = oracle.clear](const Vec3d& a, const Vec3d& b) {
      const Vec3<Enclosure> way = box_about(a, b);
      bool inside = true;
      for (int k = 0; k < 3; ++k) {
        if (way[k].hi < lo[k] || way[k].lo > hi[k]) return true;
        inside &= way[k].lo > lo[k] && way[k].hi < hi[k];
      }
      // A face of the box is none where the function is positive.
      return uncut(a, b) && (inside || open || f(Vec3l(a)) > 0);
    };
  cut(oracle, beyond, open);
  oracle.clear = clear, oracle.lo = lo, oracle.hi = hi;
}

ExactOracle oracle_of(const TorusShape& s) {
  const double r = s.major + s.minor;
  const auto f = [s](const Vec3l& p) {
    const Real d = s.major - std::sqrt(p.x * p.x + p.y * p.y);
    return d * d + p.z * p.z - static_cast<Real>(s.minor) * s.minor;
  };
  return {{s}, f, {-r, -r, -s.minor}, {r, r, s.minor}};
}

namespace {

/// By the other of the two equations that a cyclide has: the kernel solves the one with z.
ExactOracle cyclide(CaseRandom& random) {
  auto s = draw_shape<CyclideShape>(random);
  // A torus, any taper, a horn that just closes, a tube without a mean radius.
  const double kind = random.unit();
  s.taper = kind < 0.1 ? 0 : s.major * (0.98 * random.unit());
  if (kind > 0.8) s.minor = s.taper;
  if (kind > 0.9) s.minor = 0, s.taper = std::max(s.taper, 0.1 * s.major);
  const double a = s.major, c = s.taper, d = s.minor;
  const auto f = [a, c, d](const Vec3l& p) {
    const Real bb = static_cast<Real>(a) * a - static_cast<Real>(c) * c;
    const Real r = dot(p, p) + bb - static_cast<Real>(d) * d;
    const Real x = a * p.x - static_cast<Real>(c) * d;
    return r * r - 4 * (x * x + bb * p.y * p.y);
  };
  return {{s}, f, {-a - c - d, -a - d, -c - d}, {std::max(a + d - c, a - d + c), a + d, c + d}};
}

std::vector<ExactCase> make_cases() {
  std::vector<ExactCase> all{
      {"torus", [](CaseRandom& random) { return oracle_of(draw_shape<TorusShape>(random)); }},
      {"cyclide", cyclide}};
  // New ones come last: the others keep their numbers, and with them their random shapes.
  for (const auto& family :
       {quadric_cases(), polynomial_cases(), prism_cases(), sweep_cases(), superquadric_cases(),
        metaball_cases(), blobtree_cases(), function_cases(), fractal_cases(), height_cases(),
        capsule_cases(), patch_cases(), parametric_cases(), ovus_cases()})
    all.insert(all.end(), family.begin(), family.end());
  return all;
}

const std::vector<ExactCase>& all_cases() {
  static const std::vector<ExactCase> all = make_cases();
  return all;
}

}  // namespace

ExactOracle draw_exact_oracle(std::size_t form, CaseRandom& random) {
  const ExactCase& one = all_cases()[form];
  ExactOracle oracle = one.draw(random);
  oracle.name = one.name;
  return oracle;
}

std::vector<ExactOracle> draw_exact_oracles(CaseRandom& random) {
  std::vector<ExactOracle> oracles;
  for (std::size_t form = 0; form < all_cases().size(); ++form)
    oracles.push_back(draw_exact_oracle(form, random));
  return oracles;
}

std::uint64_t exact_key(std::size_t form, std::uint64_t trial) { return mix_bits(form + 1) + trial; }

Affine random_turn(CaseRandom& random) {
  Affine a = Affine::rotation(random.vector() * 180.0);
  if (random.unit() < 0.5)
    a = a * Affine::scaling({0.4 + random.unit(), 0.4 + random.unit(), 0.4 + random.unit()});
  return random.unit() < 0.2 ? Affine{} : a;
}

std::vector<std::string> exact_oracle_names() {
  std::vector<std::string> names;
  for (const ExactCase& one : all_cases()) names.push_back(one.name);
  return names;
}

}  // namespace oktett
