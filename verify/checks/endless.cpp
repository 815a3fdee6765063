#include "verify/checks/endless.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <numeric>
#include <set>

#include "core/random.h"
#include "verify/checks/findings.h"
#include "verify/oracles/known_shapes.h"

namespace oktett {

namespace {

using Clock = std::chrono::steady_clock;

/// Rounds are larger up to this one by doubling: small pieces are found quickly, large ones use all threads.
constexpr std::uint64_t kLargestRound = 4;

class Endless {
 public:
  Endless(const EndlessOptions& options, const EndlessReport& report)
      : options_(options), report_(report), meshes_(make_closed_meshes()) {
    coverage_.rows = {{"kernels", "kernels x classes", 0, std::size_t{kKernels} * kCaseClasses},
                      {"scenes", "kinds of shapes", 0, known_kinds().size()},
                      {"surfaces", "exact surfaces", 0, exact_oracle_names().size()},
                      {"combinations", "trees of any shape", 0, 1},
                      {"changes", "sequences of any kind", 0, 1},
                      {"trace_scene", "scenes with time", 0, 1},
                      {"meshes", "meshes x placements", 0, meshes_.size() * mesh_placements().size()},
                      {"roots", "degrees", 0, kKnownRootsDegree}};
    for (std::size_t k = 0; k < coverage_.rows.size(); ++k)
      next_.push_back(mix_bits(mix_bits(options.seed) + k) >> 1);
  }

  Coverage run() {
    while (in_time()) {
      const std::uint64_t size = std::uint64_t{1} << std::min(coverage_.rounds, kLargestRound);
      const bool complete = kernels(2048 * size) && scenes(8 * size) && surfaces(512 * size) &&
                            combinations(4 * size) && changes(4 * size) && trace_scenes(16 * size) &&
                            meshes(512 * size) && roots(512 * size);
      coverage_.rounds += complete;
    }
    coverage_.seconds = seconds();
    return coverage_;
  }

 private:
  enum Family : std::size_t {
    kKernelRow,
    kSceneRow,
    kSurfaceRow,
    kCombinationRow,
    kChangesRow,
    kTraceSceneRow,
    kMeshRow,
    kRootsRow
  };

  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  bool in_time() const { return seconds() < options_.seconds; }

  /// The number of the first of `count` new cases of a family.
  std::uint64_t take(Family family, std::uint64_t count) {
    next_[family] += count;
    return next_[family] - count;
  }

  bool kernels(std::uint64_t rays) {
    for (int k = 0; k < kKernels; ++k)
      for (int c = 0; c < kCaseClasses; ++c) {
        if (!in_time()) return false;
        const auto id = static_cast<KernelId>(k);
        const auto kind = static_cast<CaseClass>(c);
        const KernelTally t = verify_kernel(id, kind, rays, options_.isas, take(kKernelRow, rays));
        count(kKernelRow, {fmt::format("{} {}", k, c)}, rays, t.rays);
        if (!t.failure.empty()) found(kKernelRow, to_string(id), [&] { return finding_of(id, kind, t); });
      }
    return true;
  }

  bool scenes(std::uint64_t scenes) {
    for (std::uint64_t done = 0; done < scenes; done += kScenes) {
      if (!in_time()) return false;
      const std::uint64_t n = std::min(kScenes, scenes - done), first = take(kSceneRow, n);
      const SceneTally t = verify_scenes(n, options_.isas, first);
      count(kSceneRow, t.kinds, t.scenes, t.rays);
      if (!t.failure.empty()) found(kSceneRow, "", [&] { return finding_of(t); });
    }
    return true;
  }

  bool surfaces(std::uint64_t rays) {
    for (std::size_t form = 0; form < coverage_.rows[kSurfaceRow].of; ++form) {
      if (!in_time()) return false;
      const std::uint64_t trials = rays / kRaysPerShape;
      const ExactTally t = verify_exact(form, rays, options_.isas, take(kSurfaceRow, trials));
      count(kSurfaceRow, {fmt::format("{}", form)}, trials, t.rays);
      if (!t.failure.empty())
        found(kSurfaceRow, fmt::format("{}", form), [&] { return finding_of(form, t); });
    }
    return true;
  }

  bool combinations(std::uint64_t trees) {
    if (!in_time()) return false;
    const CsgTally t = verify_csg(trees * kRaysPerTree, options_.isas, take(kCombinationRow, trees));
    count(kCombinationRow, {"trees"}, trees, t.rays);
    if (!t.failure.empty()) found(kCombinationRow, "", [&] { return finding_of(t); });
    return true;
  }

  bool changes(std::uint64_t sequences) {
    if (!in_time()) return false;
    const ChangesTally t = verify_changes(sequences, options_.isas, take(kChangesRow, sequences));
    count(kChangesRow, {"sequences"}, sequences, t.rays);
    if (!t.failure.empty()) found(kChangesRow, "", [&] { return finding_of(t); });
    return true;
  }

  bool trace_scenes(std::uint64_t scenes) {
    if (!in_time()) return false;
    const TraceScenesTally t = verify_trace_scenes(scenes, options_.isas, take(kTraceSceneRow, scenes));
    count(kTraceSceneRow, {"scenes"}, scenes, t.rays);
    if (!t.failure.empty()) found(kTraceSceneRow, "", [&] { return finding_of(t); });
    return true;
  }

  /// Each mesh in one place, another one in each round.
  bool meshes(std::uint64_t rays) {
    const std::vector<MeshPlacement> placements = mesh_placements();
    for (std::size_t i = 0; i < meshes_.size(); ++i) {
      if (!in_time()) return false;
      const std::size_t p = (i + coverage_.rounds) % placements.size();
      const std::uint64_t first = take(kMeshRow, rays);
      const MeshTally t = verify_mesh(meshes_[i], placements[p], rays, options_.isas, {}, first);
      count(kMeshRow, {fmt::format("{} {}", i, p)}, 1, t.rays);
      if (!t.failure.empty())
        found(kMeshRow, meshes_[i].name, [&] { return finding_of(meshes_[i], p, first, rays, t); });
    }
    return true;
  }

  bool roots(std::uint64_t polynomials) {
    for (int degree = 1; degree <= kKnownRootsDegree; ++degree) {
      if (!in_time()) return false;
      const RootsTally t = verify_roots(degree, polynomials, take(kRootsRow, polynomials));
      count(kRootsRow, {fmt::format("{}", degree)}, t.polynomials, 0);
      if (!t.failure.empty())
        found(kRootsRow, fmt::format("{}", degree), [&] { return finding_of(degree, t); });
    }
    return true;
  }

  void count(Family family, const std::set<std::string>& what, std::uint64_t cases, std::uint64_t rays) {
    CoverageRow& row = coverage_.rows[family];
    seen_[family].insert(what.begin(), what.end());
    row.covered = seen_[family].size(), row.cases += cases, row.rays += rays;
    if (seconds() < next_report_ || !report_.progress) return;
    next_report_ += 60;
    coverage_.seconds = seconds();
    report_.progress(coverage_);
  }

  /// Saves a finding: the first one of what goes by `name`; of scenes each.
  template <class Make>
  void found(Family family, const std::string& name, const Make& make) {
    ++coverage_.rows[family].wrong;
    if (coverage_.findings.size() >= options_.most_findings) return;
    if (family != kSceneRow && !known_.insert(fmt::format("{} {}", static_cast<int>(family), name)).second)
      return;
    Finding finding = make();
    minimize(finding, options_.isas);
    const std::filesystem::path path =
        std::filesystem::path(options_.folder) /
        fmt::format("finding-{}-{}.yaml", options_.seed, coverage_.findings.size() + 1);
    save_finding(path.string(), finding);
    coverage_.findings.push_back(path.string());
    if (report_.finding) report_.finding(path.string(), finding.what);
  }

  /// Scenes between two looks at the clock.
  static constexpr std::uint64_t kScenes = 32;

  const EndlessOptions& options_;
  const EndlessReport& report_;
  const std::vector<OracleMesh> meshes_;
  Clock::time_point start_ = Clock::now();
  double next_report_ = 60;
  Coverage coverage_;
  std::vector<std::uint64_t> next_;
  std::set<std::string> seen_[7];
  std::set<std::string> known_;
};

}  // namespace

std::uint64_t Coverage::rays() const {
  return std::accumulate(rows.begin(), rows.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const CoverageRow& row) { return sum + row.rays; });
}

std::uint64_t Coverage::wrong() const {
  return std::accumulate(rows.begin(), rows.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const CoverageRow& row) { return sum + row.wrong; });
}

Coverage verify_endless(const EndlessOptions& options, const EndlessReport& report) {
  return Endless(options, report).run();
}

}  // namespace oktett
