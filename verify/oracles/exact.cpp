#include "verify/oracles/exact.h"

#include <algorithm>
#include <cmath>

#include "verify/cases/random_parameters.h"
#include "verify/oracles/exact_families.h"

namespace oktett {

namespace {

ExactOracle torus(CaseRandom& random) {
  const auto s = draw_shape<TorusShape>(random);
  const double r = s.major + s.minor;
  return {"torus",
          {s},
          [s](const Vec3l& p) {
            const long double d = s.major - std::sqrt(p.x * p.x + p.y * p.y);
            return d * d + p.z * p.z - static_cast<long double>(s.minor) * s.minor;
          },
          {-r, -r, -s.minor},
          {r, r, s.minor},
          {}};
}

/// By the other of the two equations that a cyclide has: the kernel solves the one with z.
ExactOracle cyclide(CaseRandom& random) {
  auto s = draw_shape<CyclideShape>(random);
  // A torus, any taper, a horn that just closes, a tube without a mean radius.
  const double kind = random.unit();
  s.taper = kind < 0.1 ? 0 : s.major * (0.98 * random.unit());
  if (kind > 0.8) s.minor = s.taper;
  if (kind > 0.9) s.minor = 0, s.taper = std::max(s.taper, 0.1 * s.major);
  const double a = s.major, c = s.taper, d = s.minor;
  return {"cyclide",
          {s},
          [a, c, d](const Vec3l& p) {
            const long double bb = static_cast<long double>(a) * a - static_cast<long double>(c) * c;
            const long double r = dot(p, p) + bb - static_cast<long double>(d) * d;
            const long double x = a * p.x - static_cast<long double>(c) * d;
            return r * r - 4 * (x * x + bb * p.y * p.y);
          },
          {-a - c - d, -a - d, -c - d},
          {std::max(a + d - c, a - d + c), a + d, c + d},
          {}};
}

std::vector<DrawExact> all_families() {
  std::vector<DrawExact> all{torus, cyclide};
  for (const auto& family :
       {quadric_oracles(), polynomial_oracles(), superquadric_oracles(), metaball_oracles(),
        blobtree_oracles(), function_oracles(), fractal_oracles(), height_oracles()})
    all.insert(all.end(), family.begin(), family.end());
  return all;
}

}  // namespace

std::vector<ExactOracle> draw_exact_oracles(CaseRandom& random) {
  std::vector<ExactOracle> oracles;
  for (const DrawExact draw : all_families()) oracles.push_back(draw(random));
  return oracles;
}

std::vector<std::string> exact_oracle_names() {
  CaseRandom random(0);
  std::vector<std::string> names;
  for (const ExactOracle& oracle : draw_exact_oracles(random)) names.push_back(oracle.name);
  return names;
}

}  // namespace oktett
