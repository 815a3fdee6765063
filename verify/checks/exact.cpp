#include "verify/checks/exact.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "accel/accel.h"
#include "core/random.h"
#include "kernels/exact/march.h"
#include "verify/checks/compare_mode.h"
#include "verify/checks/kernels.h"
#include "verify/oracles/along_ray.h"

namespace oktett {

namespace {

/// A shape in a random place, its rays, and what the tracer says.
struct Trial {
  ExactOracle oracle;
  Affine to_world, to_own;
  std::shared_ptr<const Accel> accel;
  RayBatch rays;
};

Affine random_place(CaseRandom& random) {
  const double size = random.unit() < 0.5 ? 1 : random.magnitude(-2, 2);
  const double far = random.unit() < 0.25 ? 300 : 1;
  const Affine a = random_turn(random);
  return Affine::translation(random.vector() * (size * far)) * Affine::scaling({size, size, size}) * a;
}

/// Rays from a common point or from all around, aimed into the box; some along axes, some from inside.
void shoot(Trial& trial, CaseRandom& random) {
  const Vec3d middle = (trial.oracle.lo + trial.oracle.hi) * 0.5,
              half = (trial.oracle.hi - trial.oracle.lo) * 0.5;
  const auto inside = [&] { return trial.to_world.point(middle + half * random.vector()); };
  const bool camera = random.unit() < 0.5;
  const double size = length(trial.to_world.vector(half));
  const auto outside = [&] {
    const double away = size * (1.2 + 3 * random.unit());
    return trial.to_world.point(middle) + normalize(random.vector()) * away;
  };
  const Vec3d eye = outside();
  while (trial.rays.size() < kRaysPerShape / 2) {
    Vec3d from = camera ? eye : random.unit() < 0.1 ? inside() : outside(), at = inside();
    Ray ray;
    if (!camera && random.unit() < 0.1) {
      const int axis = static_cast<int>(random.unit() * 3);
      from = at, from[axis] += random.sign() < 0 ? -3 * size : 3 * size;
      Vec3d d{0, 0, 0};
      d[axis] = from[axis] < at[axis] ? 1 : -1;
      ray.direction = Vec3f(d * random.magnitude(-2, 2));
    } else {
      ray.direction = Vec3f((at - from) * (random.unit() < 0.5 ? 1.0 : random.magnitude(-2, 2)));
    }
    ray.origin = Vec3f(from);
    trial.rays.push_back(ray);
  }
}

class ExactChecker {
 public:
  /// `turn` tells which instruction set is asked in all ways.
  ExactChecker(Trial& trial, CaseRandom& random, const std::vector<Isa>& isas, std::size_t turn,
               ExactTally& tally)
      : trial_(trial), random_(random), isas_(isas), turn_(turn % isas.size()), tally_(tally) {}

  void run() {
    HitBatch first = trace(trial_.rays);
    RayBatch second;
    for (std::size_t i = 0; i < trial_.rays.size(); ++i) check(trial_.rays[i], first[i], &second);
    if (second.size() == 0) return;
    HitBatch next = trace(second);
    for (std::size_t i = 0; i < second.size(); ++i) check(second[i], next[i], nullptr);
  }

 private:
  /// All ways to trace must agree to the bit: those of one instruction set with two of each other one.
  HitBatch trace(const RayBatch& rays) {
    HitBatch reference;
    reference.resize_uninitialized(rays.size());
    closest_hit(*trial_.accel, rays.span(), reference.span(), isas_.front(), TraceMode::single);
    for (std::size_t k = 0; k < isas_.size(); ++k) {
      const Isa isa = isas_[k];
      for (const TraceMode mode : kTraceModes) {
        if (k != turn_ && mode != TraceMode::automatic && mode != TraceMode::single) continue;
        compare_mode(*trial_.accel, rays, reference, isa, mode, [&](std::size_t i, bool, bool) {
          ++tally_.differing;
          fail(rays[i], fmt::format("{} differs", to_string(isa)));
        });
      }
    }
    return reference;
  }

  void fail(const Ray& ray, const std::string& what) {
    if (tally_.failure.empty()) tally_.failure = what + "; ray " + exact_text(ray);
  }

  void check(const Ray& ray, const Hit& hit, RayBatch* next) {
    ++tally_.rays, tally_.hits += hit.valid();
    const AlongRay f(trial_.oracle, trial_.to_own, ray);
    const std::vector<long double> truth = f.crossings();
    // Near the ray's beginning and end rounding decides.
    const auto inside = [&](long double t) { return t > ray.tmin + f.slack(t) && t < ray.tmax - f.slack(t); };
    const auto first = std::find_if(truth.begin(), truth.end(), inside);
    const bool expected = first != truth.end();
    if (expected && (!hit.valid() || hit.t > *first + f.slack(*first))) {
      ++tally_.missed;
      fail(ray, fmt::format("missed the crossing at {}, {}", static_cast<double>(*first),
                            hit.valid() ? fmt::format("hit {}", hit.t) : "no hit"));
    }
    check_list(ray, f, truth);
    if (!hit.valid()) return;
    if (!(expected && std::abs(hit.t - *first) <= f.slack(*first))) {
      const auto crossing = f.crosses(hit.t);
      tally_.touched += crossing == AlongRay::Crossing::nearly;
      if (crossing == AlongRay::Crossing::no) {
        ++tally_.invented;
        fail(ray, fmt::format("hit {} where nothing is", hit.t));
      }
      if (crossing != AlongRay::Crossing::yes) return;
    }
    check_surface(ray, hit, truth, f.slack(hit.t), next);
  }

  void check_list(const Ray& ray, const AlongRay& f, const std::vector<long double>& truth) {
    std::vector<Hit> list;
    all_hits(*trial_.accel, ray, list, isas_.front());
    std::size_t at = 0;
    bool good = true;
    for (const long double t : truth) {
      const long double s = f.slack(t);
      if (t <= ray.tmin + s || t >= ray.tmax - s) continue;
      while (at < list.size() && list[at].t < t - s) ++at;
      good &= at < list.size() && list[at].t <= t + s;
    }
    // Crossings go in and out in turn.
    for (std::size_t i = 1; i < list.size(); ++i) good &= list[i].v == -list[i - 1].v;
    if (good) return;
    ++tally_.lists;
    fail(ray, fmt::format("all_hits lists {} crossings, the oracle {}", list.size(), truth.size()));
  }

  /// Moved off the surface by its error bound, the position must be off it. `slack` is that of the hit's t.
  void check_surface(const Ray& ray, const Hit& hit, const std::vector<long double>& truth, long double slack,
                     RayBatch* next) {
    const SurfaceInteraction s = surface_interaction(*trial_.accel, ray, hit);
    const auto f = [&](const auto& p) { return trial_.oracle.f(mapped(trial_.to_own, Vec3l(p))); };
    const Vec3f n = s.geometric_normal;
    const Vec3f out = offset_origin(s, n), in = offset_origin(s, -n);
    const long double here = f(s.position), above = f(out), below = f(in);
    // Within the error bound a smooth surface is flat, and f is linear.
    long double slope = std::abs(above - below), bend = std::abs(above - 2 * here + below);
    for (int k = 0; k < 3; ++k) {
      Vec3l ahead(Vec3d(s.position)), behind = ahead;
      ahead[k] += s.position_error[k], behind[k] -= s.position_error[k];
      const long double f0 = f(behind), f1 = f(ahead);
      slope = std::max(slope, std::abs(f1 - f0)), bend = std::max(bend, std::abs(f1 - 2 * here + f0));
    }
    // Where a function has a pole within the bound, no number tells how much it bends.
    const bool creased = !(bend <= 0x1p-6L * slope);
    if (creased && !(above > 0 && below < 0)) {
      std::vector<Vec3l> near, crossings;
      const Vec3l origin(Vec3d(ray.origin)), direction(Vec3d(ray.direction));
      for (int i = -16; i <= 16; ++i) near.push_back(origin + direction * (hit.t + slack * i / 16));
      for (const long double t : truth) crossings.push_back(origin + direction * t);
      if (passes_through(f, s, out, in, near, crossings)) {
        ++tally_.creased;
        return;
      }
    }
    const long double allowed = std::min(std::abs(above - here), std::abs(here - below));
    if (allowed > 0 && !creased)
      tally_.worst_residual = std::max(tally_.worst_residual, static_cast<double>(std::abs(here) / allowed));
    if (!(above > 0 && below < 0)) {
      ++tally_.off_surface;
      fail(ray,
           fmt::format("at t = {} the position is not off the surface: {}, {}, {}", hit.t,
                       static_cast<double>(below), static_cast<double>(here), static_cast<double>(above)));
      return;
    }
    if (next == nullptr) return;
    Vec3d d = random_.vector();
    const bool outwards = random_.unit() < 0.5;
    if ((dot(d, Vec3d(n)) > 0) != outwards) d = -d;
    next->push_back({outwards ? out : in, 0, Vec3f(d), std::numeric_limits<float>::infinity()});
  }

  /// Whether a surface with an edge or a tip passes through the box of the error bound: one of the
  /// `crossings` that the oracle knows lies in it, or points in it have both signs: those from `out` to `in`,
  /// those of the ray `near` the hit, which find slivers that are thinner than the others' distance, or ever
  /// more of a grid.
  template <class F>
  static bool passes_through(const F& f, const SurfaceInteraction& s, const Vec3f& out, const Vec3f& in,
                             const std::vector<Vec3l>& near, const std::vector<Vec3l>& crossings) {
    const auto within = [&](const Vec3l& p) {
      bool all = true;
      for (int k = 0; k < 3; ++k) all &= std::abs(p[k] - s.position[k]) <= s.position_error[k];
      return all;
    };
    if (std::ranges::any_of(crossings, within)) return true;
    bool negative = false, positive = false;
    const auto look = [&](const auto& p) { (f(p) < 0 ? negative : positive) = true; };
    for (int i = 0; i <= 16; ++i) look(in + (out - in) * (static_cast<float>(i) / 16));
    for (const Vec3l& p : near)
      if (within(p)) look(p);
    for (int side = 2; side <= 16 && !(negative && positive); side *= 2) {
      const int row = 2 * side + 1;
      const auto at = [&](int axis, int i) {
        return s.position[axis] + static_cast<long double>(s.position_error[axis]) * (i % row - side) / side;
      };
      for (int i = 0; i < row * row * row; ++i) look(Vec3l{at(0, i), at(1, i / row), at(2, i / row / row)});
    }
    return negative && positive;
  }

  Trial& trial_;
  CaseRandom& random_;
  const std::vector<Isa>& isas_;
  std::size_t turn_;
  ExactTally& tally_;
};

void add(ExactTally& sum, const ExactTally& t) {
  sum.rays += t.rays, sum.hits += t.hits, sum.missed += t.missed, sum.invented += t.invented;
  sum.touched += t.touched, sum.creased += t.creased, sum.off_surface += t.off_surface, sum.lists += t.lists;
  sum.differing += t.differing;
  sum.worst_residual = std::max(sum.worst_residual, t.worst_residual);
  if (sum.failure.empty()) sum.failure = t.failure, sum.trial = t.trial;
}

}  // namespace

ExactTrial exact_trial(std::size_t form, std::uint64_t trial) {
  CaseRandom random(exact_key(form, trial));
  ExactTrial out{draw_exact_oracle(form, random), {}};
  out.to_world = random_place(random);
  return out;
}

ExactTally verify_exact(std::size_t form, std::uint64_t rays, const std::vector<Isa>& isas,
                        std::uint64_t first) {
  const std::size_t trials = (rays + kRaysPerShape - 1) / kRaysPerShape;
  std::vector<ExactTally> tallies(trials);
  const std::uint64_t uncertified_before = interval::uncertified_count();
  tbb::parallel_for(std::size_t{0}, trials, [&](std::size_t k) {
    CaseRandom random(exact_key(form, first + k));
    Trial trial;
    trial.oracle = draw_exact_oracle(form, random);
    trial.to_world = random_place(random);
    trial.to_own = trial.to_world.inverse();
    trial.accel = build_accel({{trial.oracle.shape, trial.to_world}}, {BuildQuality::balanced, false});
    shoot(trial, random);
    ExactTally& tally = tallies[k];
    tally.trial = first + k;
    ExactChecker(trial, random, isas, k, tally).run();
    if (!tally.failure.empty()) tally.failure = fmt::format("trial {}: {}", tally.trial, tally.failure);
  });
  ExactTally sum;
  for (const ExactTally& t : tallies) add(sum, t);
  sum.uncertified = interval::uncertified_count() - uncertified_before;
  if (sum.uncertified > 0 && sum.failure.empty())
    sum.failure = fmt::format("{} answers took too many steps to be proved", sum.uncertified);
  return sum;
}

}  // namespace oktett
