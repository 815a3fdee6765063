#include "tests/support/random_polynomials.h"

#include <cmath>

#include "core/math.h"

namespace oktett::test {
namespace {

using roots::Polynomial;

/// p (x - r), coefficients rounded.
void multiply(Polynomial& p, double r) {
  p.c[p.degree + 1] = 0;
  for (int i = ++p.degree; i > 0; --i) p.c[i] = p.c[i - 1] - r * p.c[i];
  p.c[0] = -r * p.c[0];
}

/// p ((x - re)^2 + im^2), coefficients rounded.
void multiply_pair(Polynomial& p, double re, double im) {
  p.degree += 2;
  p.c[p.degree] = p.c[p.degree - 1] = 0;
  for (int i = p.degree; i >= 0; --i) {
    p.c[i] = (i > 1 ? p.c[i - 2] : 0) - 2 * re * (i > 0 ? p.c[i - 1] : 0) + (re * re + im * im) * p.c[i];
  }
}

Polynomial one(double factor = 1) {
  Polynomial p;
  p.degree = 0;
  p.c[0] = factor;
  return p;
}

Polynomial spread(Sequence& random, int degree, double lo, double hi) {
  Polynomial p = one(random.uniform(-2, 2));
  const double pairs = random.uniform();
  while (p.degree < degree) {
    if (p.degree + 2 <= degree && random.uniform() < pairs) {
      multiply_pair(p, random.uniform(lo, hi), random.uniform(0.01, 1) * (hi - lo));
    } else {
      multiply(p, random.uniform(lo, hi));
    }
  }
  return p;
}

Polynomial clustered(Sequence& random, int degree) {
  Polynomial p = one();
  while (p.degree < degree) {
    const double centre = random.uniform(-0.2, 1.2), width = portable::exp2(random.uniform(-40, -6));
    for (int k = 1 + random.below(4); k > 0 && p.degree < degree; --k) {
      multiply(p, centre + width * random.uniform(-1, 1));
    }
  }
  return p;
}

Polynomial near_multiple(Sequence& random, int degree) {
  Polynomial p = one();
  while (p.degree < degree) {
    const double r = random.uniform(-0.2, 1.2);
    for (int k = 1 + random.below(3); k > 0 && p.degree < degree; --k) multiply(p, r);
  }
  return p;
}

// Roots are multiples of a power of two such that all products fit into 53 bits.
Polynomial multiple(Sequence& random, int degree) {
  Polynomial p = one();
  const int bits = degree <= 4 ? 8 : degree <= 8 ? 4 : degree <= 16 ? 2 : 1;
  const double unit = std::ldexp(1, -bits);
  while (p.degree < degree) {
    const double r = unit * random.below((1 << bits) + 1);
    for (int k = 1 + random.below(3); k > 0 && p.degree < degree; --k) multiply(p, r);
  }
  return p;
}

Polynomial tangent(Sequence& random, int degree) {
  Polynomial p = one();
  while (p.degree < degree) {
    if (p.degree + 2 <= degree && random.uniform() < 0.6) {
      multiply_pair(p, random.uniform(0, 1), portable::exp2(random.uniform(-46, -10)));
    } else {
      multiply(p, random.uniform(-0.5, 1.5));
    }
  }
  return p;
}

// ((|o + t d|^2 + R^2 - r^2)^2 - 4 R^2 (x^2 + y^2)) for a ray aimed near the tube, from its closest approach.
RootProblem torus(Sequence& random) {
  const double major = 1, minor = random.uniform(0.05, 0.9);
  const double u = random.uniform(0, 6.283), v = random.uniform(0, 6.283);
  const double offset = random.below(2) ? 1 : random.uniform(0, 1.2);
  const double ring = major + minor * offset * portable::cos(v);
  const double at[3] = {ring * portable::cos(u), ring * portable::sin(u), minor * offset * portable::sin(v)};
  double d[3], o[3], length = 0;
  for (double& x : d) x = random.uniform(-1, 1), length += x * x;
  length = std::sqrt(length);
  double od = 0, oo = 0;
  for (int k = 0; k < 3; ++k) d[k] /= length, o[k] = at[k] - 3 * d[k], od += o[k] * d[k], oo += o[k] * o[k];
  const double k1 = oo + major * major - minor * minor, f = 4 * major * major;
  const double xy[3] = {o[0] * o[0] + o[1] * o[1], 2 * (o[0] * d[0] + o[1] * d[1]),
                        d[0] * d[0] + d[1] * d[1]};
  RootProblem q;
  q.p.degree = 4;
  q.p.c[4] = 1;
  q.p.c[3] = 4 * od;
  q.p.c[2] = 2 * k1 + 4 * od * od - f * xy[2];
  q.p.c[1] = 4 * k1 * od - f * xy[1];
  q.p.c[0] = k1 * k1 - f * xy[0];
  q.a = 0, q.b = 8;
  return q;
}

void scale(Sequence& random, RootProblem& q) {
  const int variable = random.below(2 * (400 / (q.p.degree + 1)) + 1) - 400 / (q.p.degree + 1);
  const int value = random.below(401) - 200;
  for (int i = 0; i <= q.p.degree; ++i) q.p.c[i] = std::ldexp(q.p.c[i], value - i * variable);
  q.a = std::ldexp(q.a, variable), q.b = std::ldexp(q.b, variable);
}

}  // namespace

const char* to_string(RootClass c) {
  constexpr const char* kNames[] = {"spread",      "coefficients", "clustered", "near multiple",
                                    "multiple",    "tangent",      "scaled",    "sparse",
                                    "at the ends", "wild",         "torus"};
  return kNames[static_cast<int>(c)];
}

RootProblem random_problem(RootClass c, int degree, std::uint64_t index) {
  Sequence random(mix_bits(index * 64 + static_cast<std::uint64_t>(degree)) + static_cast<std::uint64_t>(c));
  RootProblem q{one(), 0, 1};
  switch (c) {
    case RootClass::spread:
      q.p = spread(random, degree, -0.2, 1.2);
      break;
    case RootClass::coefficients:
      q.p.degree = degree;
      for (int i = 0; i <= degree; ++i) q.p.c[i] = random.uniform(-1, 1);
      q.a = -1.5, q.b = 1.5;
      break;
    case RootClass::clustered:
      q.p = clustered(random, degree);
      break;
    case RootClass::near_multiple:
      q.p = near_multiple(random, degree);
      break;
    case RootClass::multiple:
      q.p = multiple(random, degree);
      break;
    case RootClass::tangent:
      q.p = tangent(random, degree);
      break;
    case RootClass::scaled:
      q.p = spread(random, degree, -1, 1);
      q.a = -1;
      scale(random, q);
      break;
    case RootClass::sparse:
      q.p.degree = degree;
      for (int i = 0; i <= degree; ++i) q.p.c[i] = random.below(2) ? random.below(9) - 4 : 0;
      q.p.c[random.below(degree + 1)] = 1;
      q.a = -2, q.b = 2;
      break;
    case RootClass::at_ends: {
      q.a = random.below(3) ? random.uniform(-1, 1) : 0;
      q.b = q.a + random.uniform(0, 2);
      Polynomial& p = q.p;
      while (p.degree < degree) {
        const int kind = random.below(4);
        multiply(p, kind == 0 ? q.a : kind == 1 ? q.b : random.uniform(-1.5, 2.5));
      }
      break;
    }
    case RootClass::wild: {
      const int spread = 1 + random.below(80);
      q.p.degree = degree;
      for (int i = 0; i <= degree; ++i)
        q.p.c[i] = std::ldexp(random.uniform(-1, 1), random.below(2 * spread) - spread);
      q.a = random.below(2) ? 0 : -std::ldexp(random.uniform(), random.below(100) - 50);
      q.b = std::ldexp(random.uniform(), random.below(100) - 50);
      return q;
    }
    case RootClass::torus:
      if (degree == 4) return torus(random);
      q.p = spread(random, degree, 0, 1);
      break;
  }
  // Other intervals now and then: part of the line, all of it.
  if (c != RootClass::scaled && c != RootClass::at_ends && random.below(4) == 0) {
    q.a = random.uniform(-1, 0.9), q.b = q.a + random.uniform(0, 2);
  }
  return q;
}

}  // namespace oktett::test
