#include "verify/oracles/exact.h"

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

std::vector<DrawExact> all_families() {
  std::vector<DrawExact> all{torus};
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
