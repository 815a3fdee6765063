#include "verify/checks/kernels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

#include "core/parallel.h"
#include "core/random.h"
#include "kernels/roots/roots.h"
#include "verify/cases/kernel_cases.h"
#include "verify/checks/compare_mode.h"
#include "verify/oracles/closed.h"

namespace oktett {

void KernelTally::add(const KernelTally& o) {
  rays += o.rays, hits += o.hits, undecided += o.undecided, wrong += o.wrong;
  excess += o.excess, differing += o.differing;
  worst_ulps = std::max(worst_ulps, o.worst_ulps);
  fail(o.first_failure, o.failure);
}

bool must_be_right(KernelId id, CaseClass c) {
  const bool textbook = id == KernelId::triangle_moller_trumbore || id == KernelId::triangle_badouel ||
                        id == KernelId::triangle_segura_feito;
  return !textbook || (c != CaseClass::huge && c != CaseClass::tiny);
}

std::string exact_text(const Ray& r) {
  return fmt::format("origin {:a} {:a} {:a} direction {:a} {:a} {:a} tmin {:a} tmax {:a}", r.origin.x,
                     r.origin.y, r.origin.z, r.direction.x, r.direction.y, r.direction.z, r.tmin, r.tmax);
}

std::optional<Ray> ray_in_text(const std::string& text) {
  const std::size_t at = text.find("origin ");
  Ray r;
  if (at == std::string::npos ||
      std::sscanf(text.c_str() + at, "origin %f %f %f direction %f %f %f tmin %f tmax %f", &r.origin.x,
                  &r.origin.y, &r.origin.z, &r.direction.x, &r.direction.y, &r.direction.z, &r.tmin,
                  &r.tmax) != 8)
    return std::nullopt;
  return r;
}

namespace {

constexpr std::size_t kPairsTogether = 8192;

struct Results {
  float t[kPairsTogether], u[kPairsTogether], v[kPairsTogether];
  std::uint8_t hit[kPairsTogether];
};

/// Of the triangle tests in the order of KernelId.
constexpr TriangleTolerance kTolerances[] = {
    {}, {0, 0x1p-19, 0}, {0, 0x1p-19, 0x1p-19}, {0x1p-19, 0x1p-19, 0}};

OracleAnswer ask_oracle(KernelId id, const KernelCases& cases, std::size_t i) {
  const Ray ray = cases.rays[i];
  const auto& s = cases.shape;
  const auto corner = [&](int k) {
    return Vec3f{cases.corner[k][0][i], cases.corner[k][1][i], cases.corner[k][2][i]};
  };
  const auto vec = [&](int k) { return Vec3d{s[k][i], s[k + 1][i], s[k + 2][i]}; };
  switch (id) {
    case KernelId::sphere_geometric:
    case KernelId::sphere_algebraic:
    case KernelId::sphere_in_range:
      return oracle_sphere(ray, {vec(0), s[3][i]});
    case KernelId::plane:
      return oracle_plane(ray, {vec(0), s[3][i]});
    case KernelId::disk:
      return oracle_disk(ray, {vec(0), vec(3), s[6][i], s[7][i]});
    case KernelId::box: {
      double rows[12];
      for (int k = 0; k < 12; ++k) rows[k] = s[k][i];
      return oracle_box(ray, Affine::from_rows(rows));
    }
    case KernelId::slab:
      return oracle_slab(ray, {corner(0), corner(1)});
    default: {
      const Vec3f p[3] = {corner(0), corner(1), corner(2)};
      return oracle_triangle(ray, p, kTolerances[static_cast<int>(id)]);
    }
  }
}

/// Empty if the kernel's answer is right; updates the counts but not `wrong`.
std::string judge(KernelId id, const OracleAnswer& truth, const Results& r, std::size_t i,
                  KernelTally& tally) {
  const bool hit = r.hit[i] != 0;
  tally.hits += hit;
  if (truth.verdict == OracleVerdict::undecided) return ++tally.undecided, "";
  const bool met = truth.verdict == OracleVerdict::hit;
  if (id == KernelId::slab) {
    tally.excess += hit && !met;
    return met && !hit ? "the box is missed" : "";
  }
  if (hit != met) return fmt::format("hit {} but should be {}", hit, met);
  if (!hit) return "";
  const double ulp = std::max(std::abs(truth.t) * 0x1p-23, 0x1p-149);
  const double error = std::abs(r.t[i] - truth.t);
  if (truth.t_error < 0.01 * ulp) tally.worst_ulps = std::max(tally.worst_ulps, error / ulp);
  if (!(error <= truth.t_error + 0.51 * ulp))
    return fmt::format("t {:a} but should be {:a} +- {:g}", r.t[i], truth.t, truth.t_error);
  const bool triangle = id <= KernelId::triangle_segura_feito;
  const double uv_error = truth.uv_error + 0x1p-24;
  if (triangle && !(std::abs(r.u[i] - truth.u) <= uv_error && std::abs(r.v[i] - truth.v) <= uv_error))
    return fmt::format("u, v {:a} {:a} but should be {:a} {:a}", r.u[i], r.v[i], truth.u, truth.v);
  return "";
}

KernelTally verify_chunk(KernelId id, CaseClass c, std::uint64_t first, std::size_t count,
                         const std::vector<Isa>& isas) {
  KernelTally tally;
  tally.rays = count;
  KernelCases cases;
  cases.fill(id, c, first, count);
  const auto results = std::make_unique<Results[]>(2);
  Results &reference = results[0], &other = results[1];
  const auto run = [&](Isa isa, int width, Results& out) {
    KernelProbe k = cases.run(0, count);
    k.t = out.t, k.u = out.u, k.v = out.v, k.hit = out.hit;
    probe_kernel(isa, id, width, k);
  };
  run(Isa::scalar, 1, reference);
  for (const Isa isa : isas)
    for (const int width : probe_widths(isa)) {
      run(isa, width, other);
      for (std::size_t i = 0; i < count; ++i) {
        // The slab test is held to be conservative, not identical.
        const bool same =
            id == KernelId::slab ||
            (other.hit[i] == reference.hit[i] && (!other.hit[i] || (same_bits(other.t[i], reference.t[i]) &&
                                                                    same_bits(other.u[i], reference.u[i]) &&
                                                                    same_bits(other.v[i], reference.v[i]))));
        const bool lost = id == KernelId::slab && !other.hit[i] && reference.hit[i] &&
                          ask_oracle(id, cases, i).verdict == OracleVerdict::hit;
        if (same && !lost) continue;
        ++tally.differing;
        tally.fail(first + i, fmt::format("{} width {} differs from scalar: {}", to_string(isa), width,
                                          exact_text(cases.rays[i])));
      }
    }
  for (std::size_t i = 0; i < count; ++i) {
    const std::string complaint = judge(id, ask_oracle(id, cases, i), reference, i, tally);
    if (complaint.empty()) continue;
    ++tally.wrong;
    if (must_be_right(id, c)) tally.fail(first + i, complaint + ": " + exact_text(cases.rays[i]));
  }
  return tally;
}

}  // namespace

KernelTally verify_kernel(KernelId id, CaseClass c, std::uint64_t rays, const std::vector<Isa>& isas,
                          std::uint64_t first_pair) {
  const Chunks chunks(rays, kPairsTogether);
  std::vector<KernelTally> parts(chunks.count);
  chunks.each(true, [&](std::size_t k, std::size_t begin, std::size_t end) {
    parts[k] = verify_chunk(id, c, first_pair + begin, end - begin, isas);
  });
  KernelTally total;
  for (const KernelTally& part : parts) total.add(part);
  return total;
}

// ---- Root finders against polynomials whose roots are known exactly.

namespace {

using roots::Method;

struct KnownRoots {
  roots::Polynomial p;
  double a = 0, b = 0;
  std::vector<double> inside;  ///< roots in [a, b] in ascending order, as often as they count
};

class RootsMaker {
 public:
  RootsMaker(int degree, std::uint64_t number)
      : random_(mix_bits(number) + static_cast<std::uint64_t>(degree)),
        degree_(degree),
        // The integers stay below 2^50.
        bits_(50 / degree - 2) {}

  KnownRoots make() {
    while (std::ssize(c_) <= degree_) add_factor();
    const int shift = below(41) - 20, size = below(201) - 100;
    const double sign = random_.unit() < 0.5 ? -1 : 1;
    KnownRoots known;
    known.p.degree = degree_;
    for (int i = 0; i <= degree_; ++i)
      known.p.c[i] =
          sign * std::ldexp(static_cast<double>(c_[static_cast<std::size_t>(i)]), size + i * (bits_ - shift));
    // Ends lie halfway between points of the grid.
    const double half = std::ldexp(1.0, shift - bits_ - 1);
    double ends[2];
    for (double& end : ends) end = half * static_cast<double>(2 * coordinate() + 1);
    known.a = std::min(ends[0], ends[1]), known.b = std::max(ends[0], ends[1]);
    for (const std::int64_t root : roots_)
      if (const double x = 2 * half * static_cast<double>(root); x > known.a && x < known.b)
        known.inside.push_back(x);
    std::ranges::sort(known.inside);
    return known;
  }

 private:
  int below(int n) { return static_cast<int>(random_.unit() * n); }

  /// A point of the grid, often close to the one before.
  std::int64_t coordinate() {
    const auto most = static_cast<double>(std::int64_t{1} << bits_);
    if (random_.unit() < 0.4) {
      const auto step = static_cast<std::int64_t>(std::pow(most, 0.7 * random_.unit()) - 0.9);
      if (std::abs(last_ - step) < static_cast<std::int64_t>(most)) return last_ -= step;
    }
    return last_ = static_cast<std::int64_t>(random_.sign() * most);
  }

  /// Multiplies by x - k, or by (x - k)^2 + j^2, in units of the grid.
  void add_factor() {
    const std::int64_t k = coordinate();
    if (degree_ + 1 - std::ssize(c_) >= 2 && random_.unit() < 0.25) {
      const auto j =
          static_cast<std::int64_t>(std::pow(static_cast<double>(std::int64_t{1} << bits_), random_.unit()));
      return multiply({k * k + j * j, -2 * k, 1});
    }
    roots_.push_back(k);
    multiply({-k, 1});
  }

  void multiply(const std::vector<std::int64_t>& factor) {
    std::vector<std::int64_t> product(c_.size() + factor.size() - 1);
    for (std::size_t i = 0; i < c_.size(); ++i)
      for (std::size_t k = 0; k < factor.size(); ++k) product[i + k] += c_[i] * factor[k];
    c_ = std::move(product);
  }

  CaseRandom random_;
  int degree_, bits_;
  std::vector<std::int64_t> c_{1}, roots_;
  std::int64_t last_ = 0;
};

/// What is wrong with a certified answer; empty if nothing is.
std::string judge(const KnownRoots& known, const roots::Roots& answer) {
  const auto holds = [](const roots::Root& r, double x) { return std::abs(x - r.x) <= r.error; };
  for (const double x : known.inside)
    if (std::none_of(answer.root, answer.root + answer.count,
                     [&](const roots::Root& r) { return holds(r, x); }))
      return fmt::format("the root {} is missed", x);
  for (int i = 0; i < answer.count; ++i) {
    const roots::Root& r = answer.root[i];
    // Intervals that overlap share their roots.
    const auto apart = [&](const roots::Root& other) {
      return std::abs(r.x - other.x) > r.error + other.error;
    };
    if ((i > 0 && !apart(answer.root[i - 1])) || (i + 1 < answer.count && !apart(answer.root[i + 1])))
      continue;
    const auto held = std::ranges::count_if(known.inside, [&](double x) { return holds(r, x); });
    if (held > r.multiplicity || (r.multiplicity - held) % 2 != 0)
      return fmt::format("{} +- {} should be {} roots, but {} are there", r.x, r.error, r.multiplicity, held);
  }
  return "";
}

}  // namespace

RootsTally verify_roots(int degree, std::uint64_t count, std::uint64_t first) {
  RootsTally tally;
  for (std::uint64_t number = first; number < first + count; ++number) {
    const KnownRoots known = RootsMaker(degree, number).make();
    ++tally.polynomials, tally.roots += known.inside.size();
    for (const Method method : {Method::automatic, Method::bernstein, Method::closed, Method::sturm}) {
      const roots::Roots answer = roots::solve(known.p, known.a, known.b, method);
      const bool must = method == Method::automatic || method == Method::bernstein;
      std::string wrong;
      if (answer.certified)
        wrong = judge(known, answer);
      else if (must)
        wrong = "the answer is not certified";
      else
        ++tally.uncertain;
      if (wrong.empty()) continue;
      if (tally.failure.empty())
        tally.failure = fmt::format("{}, degree {}: {}", to_string(method), degree, wrong),
        tally.first_failure = number;
      ++tally.wrong;
    }
  }
  return tally;
}

}  // namespace oktett
