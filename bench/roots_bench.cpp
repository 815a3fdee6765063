/// \file Root finders by method and degree, and those in lanes by instruction set. An item is a polynomial.
///
///     bench_roots [--benchmark_filter=REGEX]
///
/// `solve/METHOD/DEGREE` finds all roots in [0, 1], `first/...` the least; half of the roots are real and
/// spread over a little more than the interval. `torus/...` are rays against a torus. roots_verify counts how
/// often the answers are right (docs/roots.md).

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "core/random.h"
#include "core/vec3.h"
#include "kernels/roots/roots.h"
#include "verify/probes/kernel_probe.h"

namespace oktett::bench {
namespace {

using roots::Method;
using roots::Polynomial;

constexpr std::size_t kProblems = 4096;

double number(std::size_t i, std::uint32_t dimension) { return random_float(pixel_key(3, i), 0, dimension); }

struct Problem {
  Polynomial p;
  double a = 0, b = 1;
};

Problem spread(int degree, std::size_t i) {
  Problem q;
  Polynomial& p = q.p;
  p.degree = 0;
  p.c[0] = 1;
  std::uint32_t dimension = 0;
  while (p.degree < degree) {
    const double re = 1.4 * number(i, dimension) - 0.2, im = 0.05 + number(i, dimension + 1);
    const bool pair = p.degree + 2 <= degree && number(i, dimension + 2) < 1.0f / 3;
    dimension += 3;
    for (int k = p.degree + 1; k <= p.degree + 2; ++k) p.c[k] = 0;
    p.degree += pair ? 2 : 1;
    for (int k = p.degree; k >= 0; --k) {
      const double one = k > 0 ? p.c[k - 1] : 0, two = k > 1 ? p.c[k - 2] : 0;
      p.c[k] = pair ? two - 2 * re * one + (re * re + im * im) * p.c[k] : one - re * p.c[k];
    }
  }
  return q;
}

/// A ray from outside towards the box around a torus. The interval is where the ray is inside of the bounding
/// sphere.
Problem torus(std::size_t i) {
  const double major = 1, minor = 0.35, f = 4 * major * major, radius = major + minor;
  Vec3d o, d;
  for (int k = 0; k < 3; ++k) o[k] = 2 * number(i, k) - 1;
  o *= 3 / length(o);
  for (int k = 0; k < 3; ++k) d[k] = (number(i, k + 3) - 0.5) * (k == 2 ? 2 * minor : 2 * radius) - o[k];
  d = d / length(d);
  // From the point nearest to the centre.
  o -= d * dot(o, d);
  const double pp = dot(o, o);
  const double k1 = pp - major * major - minor * minor;
  Problem q;
  q.p.degree = 4;
  q.p.c[4] = 1, q.p.c[3] = 0, q.p.c[2] = 2 * k1 + f * d.z * d.z, q.p.c[1] = 2 * f * o.z * d.z;
  q.p.c[0] = k1 * k1 + f * (o.z * o.z - minor * minor);
  q.b = std::sqrt(std::max(0.0, radius * radius - pp));
  q.a = -q.b;
  return q;
}

std::vector<Problem> problems(bool rays, int degree) {
  std::vector<Problem> all;
  for (std::size_t i = 0; i < kProblems; ++i) all.push_back(rays ? torus(i) : spread(degree, i));
  return all;
}

void run_solve(benchmark::State& state, Method method, int degree, bool rays, int wanted) {
  const std::vector<Problem> all = problems(rays, degree);
  std::size_t found = 0, certified = 0, rounds = 0;
  for (auto _ : state) {
    for (const Problem& q : all) {
      const roots::Roots answer = roots::solve(q.p, q.a, q.b, method, wanted);
      found += answer.count, certified += answer.certified;
    }
    ++rounds;
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kProblems));
  state.counters["roots"] = static_cast<double>(found) / (kProblems * rounds);
  state.counters["certified"] = static_cast<double>(certified) / (kProblems * rounds);
}

void run_lanes(benchmark::State& state, RootsKernel id, int degree, bool rays, Isa isa) {
  std::vector<double> c[7], a, b, x[6], error[6];
  std::vector<std::uint8_t> unsure(kProblems);
  for (const Problem& q : problems(rays, degree)) {
    for (int k = 0; k < 7; ++k) c[k].push_back(k <= degree ? q.p.c[k] : 0);
    a.push_back(q.a), b.push_back(q.b);
  }
  RootsProbe run;
  run.count = kProblems;
  for (int k = 0; k < 7; ++k) run.c[k] = c[k].data();
  for (int k = 0; k < 6; ++k) {
    x[k].resize(kProblems), error[k].resize(kProblems);
    run.x[k] = x[k].data(), run.error[k] = error[k].data();
  }
  run.a = a.data(), run.b = b.data(), run.unsure = unsure.data();
  for (auto _ : state) {
    probe_roots(isa, id, run);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kProblems));
}

void register_solve(const std::string& name, Method method, int degree, bool rays, int wanted) {
  benchmark::RegisterBenchmark(name.c_str(),
                               [=](benchmark::State& s) { run_solve(s, method, degree, rays, wanted); });
}

/// Runs before main().
[[maybe_unused]] const bool registered = [] {
  constexpr Method kMethods[] = {Method::automatic, Method::closed,    Method::bernstein, Method::sturm,
                                 Method::laguerre,  Method::bisection, Method::newton};
  for (const int degree : {2, 3, 4, 6, 8, 12, 16, 24, 32}) {
    for (const Method method : kMethods) {
      if (method == Method::closed && degree > 4) continue;
      register_solve(fmt::format("solve/{}/{}", to_string(method), degree), method, degree, false,
                     roots::kMaxDegree);
    }
    register_solve(fmt::format("first/auto/{}", degree), Method::automatic, degree, false, 1);
  }
  for (const Method method : kMethods) {
    register_solve(fmt::format("torus/{}", to_string(method)), method, 4, true, roots::kMaxDegree);
  }
  register_solve("torus/auto/first", Method::automatic, 4, true, 1);
  const std::tuple<const char*, RootsKernel, int> kernels[] = {
      {"closed", RootsKernel::closed2, 2}, {"closed", RootsKernel::closed3, 3},
      {"closed", RootsKernel::closed4, 4}, {"all", RootsKernel::all2, 2},
      {"all", RootsKernel::all3, 3},       {"all", RootsKernel::all4, 4},
      {"all", RootsKernel::all6, 6},       {"first", RootsKernel::first4, 4}};
  for (const Isa isa : available_isas()) {
    for (const auto& [name, id, degree] : kernels) {
      for (const bool rays : {false, true}) {
        if (rays && degree != 4) continue;
        benchmark::RegisterBenchmark(
            fmt::format("lanes/{}/{}/{}{}", to_string(isa), name, degree, rays ? "/torus" : "").c_str(),
            [kernel = id, n = degree, rays, isa](benchmark::State& s) {
              run_lanes(s, kernel, n, rays, isa);
            });
      }
    }
  }
  return true;
}();

}  // namespace
}  // namespace oktett::bench
