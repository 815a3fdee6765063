/// \file Normals of exact surfaces by gradient, forward and central differences: time per surface, and the
/// greatest and mean angle to the true normal in radians.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "core/random.h"
#include "kernels/exact/polynomial_expression.h"
#include "verify/oracles/exact.h"

namespace oktett::bench {
namespace {

PolynomialShape polynomial(const std::string& equation) {
  return {expand_polynomial(equation), {-1.2, -1.2, -1.2}, {1.2, 1.2, 1.2}, true};
}

/// Surfaces and what they should be.
std::vector<ExactOracle> subjects() {
  MetaballsShape balls{0.5, {}};
  for (const double x : {-0.4, 0.0, 0.5}) balls.balls.push_back({{x, 0.3 * x, x * x}, 0.8, 1});
  SuperquadricShape super;
  super.p = 3, super.q = 3.5, super.r = 4;
  std::vector<ExactOracle> all = {
      oracle_of(TorusShape{0.7, 0.3}), oracle_of(polynomial("x^4 + y^4 + z^4 = 1")),
      oracle_of(polynomial("x^12 + y^12 + z^12 = 1")), oracle_of(super), oracle_of(balls)};
  const char* const names[] = {"torus", "quartic", "degree_12", "superellipsoid", "metaballs"};
  for (std::size_t i = 0; i < all.size(); ++i) all[i].name = names[i];
  return all;
}

/// The true direction of the normal, by differences of a function that has many more digits.
Vec3l true_normal(const SurfaceFunction& f, const Vec3l& p) {
  constexpr long double kStep = 0x1p-20L;
  Vec3l n;
  for (int k = 0; k < 3; ++k) {
    Vec3l ahead = p, behind = p;
    ahead[k] += kStep, behind[k] -= kStep;
    n[k] = f(ahead) - f(behind);
  }
  return normalize(n);
}

void normals(benchmark::State& state, const ExactOracle& subject, NormalMethod method) {
  const auto accel = build_accel({{ExactShape{subject.shape.form, method}, Affine{}}});
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
    const Vec3l n = normalize(Vec3l(s.geometric_normal)), truth = true_normal(subject.f, Vec3l(s.position));
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
  for (const ExactOracle& subject : subjects())
    for (const auto& [name, method] :
         {std::pair<const char*, NormalMethod>{"gradient", NormalMethod::gradient},
          {"forward", NormalMethod::forward},
          {"central", NormalMethod::central}})
      benchmark::RegisterBenchmark((subject.name + "/" + name).c_str(), normals, subject, method);
  return true;
}();

}  // namespace
}  // namespace oktett::bench
