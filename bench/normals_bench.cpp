/// \file Normals of exact surfaces by gradient, forward and central differences: time per surface, and the
/// greatest and mean angle to the true normal in radians.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "core/random.h"
#include "kernels/exact/polynomial_expression.h"

namespace oktett::bench {
namespace {

using Vec3l = Vec3<long double>;

/// A surface and the true direction of its normal.
struct Subject {
  std::string name;
  ExactForm form;
  std::function<Vec3l(const Vec3l&)> gradient;
};

PolynomialShape polynomial(const std::string& equation) {
  PolynomialShape s;
  s.terms = expand_polynomial(equation);
  s.lo = {-1.2, -1.2, -1.2}, s.hi = {1.2, 1.2, 1.2}, s.open = true;
  return s;
}

std::vector<Subject> subjects() {
  MetaballsShape balls{0.5, {}};
  for (const double x : {-0.4, 0.0, 0.5}) balls.balls.push_back({{x, 0.3 * x, x * x}, 0.8, 1});
  SuperquadricShape super;
  super.p = 3, super.q = 3.5, super.r = 4;
  const auto power = [](long double x, long double p) {
    return p * std::pow(std::abs(x), p - 1) * (x < 0 ? -1 : 1);
  };
  return {
      {"torus", TorusShape{0.7, 0.3},
       [](const Vec3l& p) {
         const long double rho = std::sqrt(p.x * p.x + p.y * p.y), k = 1 - 0.7L / rho;
         return Vec3l{p.x * k, p.y * k, p.z};
       }},
      {"quartic", polynomial("x^4 + y^4 + z^4 = 1"),
       [](const Vec3l& p) {
         return Vec3l{p.x * p.x * p.x, p.y * p.y * p.y, p.z * p.z * p.z};
       }},
      {"degree_12", polynomial("x^12 + y^12 + z^12 = 1"),
       [](const Vec3l& p) {
         return Vec3l{std::pow(p.x, 11.0L), std::pow(p.y, 11.0L), std::pow(p.z, 11.0L)};
       }},
      {"superellipsoid", super,
       [power](const Vec3l& p) {
         return Vec3l{power(p.x, 3), power(p.y, 3.5L), power(p.z, 4)};
       }},
      {"metaballs", balls,
       [balls](const Vec3l& p) {
         Vec3l g{0, 0, 0};
         for (const MetaBall& ball : balls.balls) {
           const Vec3l d = p - Vec3l(ball.center);
           const long double r = ball.radius, q = 1 - dot(d, d) / (r * r);
           if (q > 0) g += d * (4 * q / (r * r));
         }
         return g;
       }},
  };
}

void normals(benchmark::State& state, const Subject& subject, NormalMethod method) {
  const auto accel = build_accel({{ExactShape{subject.form, method}, Affine{}}});
  RayBatch rays;
  const auto number = [](std::uint32_t i, std::uint32_t k) {
    return 2 * random_float(pixel_key(7, i), 0, k) - 1;
  };
  for (std::uint32_t i = 0; i < 4096; ++i) {
    const Vec3f from = normalize(Vec3f{number(i, 0), number(i, 1), number(i, 2)}) * 4.0f;
    rays.push_back({from, 0, Vec3f{number(i, 3), number(i, 4), number(i, 5)} * 0.8f - from});
  }
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  closest_hit(*accel, rays.span(), hits.span(), default_isa());
  std::vector<std::uint32_t> which;
  for (std::uint32_t i = 0; i < rays.size(); ++i)
    if (hits[i].valid()) which.push_back(i);
  double greatest = 0, sum = 0;
  for (const std::uint32_t i : which) {
    const SurfaceInteraction s = surface_interaction(*accel, rays[i], hits[i]);
    const Vec3l n = normalize(Vec3l(s.geometric_normal)),
                truth = normalize(subject.gradient(Vec3l(s.position)));
    const double angle = static_cast<double>(2 * std::asin(std::min(length(n - truth) / 2, 1.0L)));
    greatest = std::max(greatest, angle), sum += angle;
  }
  InteractionBlock block;
  for (auto _ : state)
    for (std::size_t first = 0; first < which.size(); first += InteractionBlock::kMost) {
      surface_interactions(*accel, rays, hits,
                           {which.data() + first, std::min(InteractionBlock::kMost, which.size() - first)},
                           block);
      benchmark::DoNotOptimize(block);
    }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(which.size()));
  state.counters["greatest"] = greatest;
  state.counters["mean"] = sum / static_cast<double>(which.size());
}

/// Runs before main().
[[maybe_unused]] const bool registered = [] {
  for (const Subject& subject : subjects())
    for (const auto& [name, method] :
         {std::pair<const char*, NormalMethod>{"gradient", NormalMethod::gradient},
          {"forward", NormalMethod::forward},
          {"central", NormalMethod::central}})
      benchmark::RegisterBenchmark((subject.name + "/" + name).c_str(), normals, subject, method);
  return true;
}();

}  // namespace
}  // namespace oktett::bench
