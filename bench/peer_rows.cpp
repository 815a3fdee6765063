#include "bench/peer_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/bench_rays.h"
#include "bench/embree_peer.h"
#include "bench/peer_picture.h"
#include "bench/peer_timing.h"
#include "bench/peer_trace.h"
#include "core/error.h"

namespace oktett::bench {
namespace {

/// A way of building a tree.
struct BuildVariant {
  std::string name;
  BuildOptions options;
};

/// All that the comparison measures; the first is Oktett's default.
const BuildVariant kBuildVariants[] = {{"balanced", {BuildQuality::balanced}},
                                       {"fast", {BuildQuality::fast}},
                                       {"best", {BuildQuality::best}},
                                       {"compact", {BuildQuality::compact}}};

/// The variant called `name`, the first for an empty name. Throws Error if there is none.
const BuildVariant& find_variant(const std::string& name) {
  if (name.empty()) return kBuildVariants[0];
  const auto* at = std::ranges::find(kBuildVariants, name, &BuildVariant::name);
  if (at == std::end(kBuildVariants)) throw Error("there is no way to build called '" + name + "'");
  return *at;
}

std::string embree_config(Isa isa) {
  return isa == Isa::avx2 ? "isa=avx2" : isa == Isa::sse42 ? "isa=sse4.2" : "";
}

Quartiles rates(const std::vector<double>& seconds, double count) {
  std::vector<double> rates;
  for (const double s : seconds) rates.push_back(count / s);
  return quartiles(rates);
}

/// Seconds that the same work took Oktett, its rivals and the null tracer, in turn.
struct Times {
  std::vector<double> oktett, null, embree[kRivals], ratio[kRivals];
  void add(double ours, const std::array<double, kRivals>& theirs) {
    oktett.push_back(ours);
    for (int k = 0; k < kRivals; ++k) embree[k].push_back(theirs[k]), ratio[k].push_back(theirs[k] / ours);
  }
};

/// What f makes of each rival's number.
template <class F>
auto each_rival(const F& f) {
  return std::array{f(0), f(1)};
}

/// All rows of one scene.
class Comparison {
 public:
  Comparison(const PeerScene& scene, const PeerOptions& options, Isa isa, PeerReport& report)
      : scene_(scene), options_(options), isa_(isa), config_(embree_config(isa)), report_(report) {}

  void run() {
    build_rows();
    if (!options_.wants_tracing()) return;
    const std::size_t agreed = report_.agreements.size();
    for (const bool inside : options_.inside)
      for (const int resolution : options_.resolutions) view_rows({resolution, inside});
    print_agreement(
        {report_.agreements.begin() + static_cast<std::ptrdiff_t>(agreed), report_.agreements.end()});
  }

 private:
  /// Embree's scenes, made when they are first needed.
  const EmbreeScene& embree(EmbreeKind kind) {
    std::unique_ptr<EmbreeScene>& scene = embree_[kind];
    if (scene == nullptr) scene = std::make_unique<EmbreeScene>(scene_, kind, config_);
    return *scene;
  }
  const EmbreeScene& medium(int rival) { return embree({1, rival == 1}); }

  Row row(const View& view, int threads, const std::string& work, const std::string& unit) const {
    Row row;
    row.mesh = scene_.name, row.inside = view.inside, row.resolution = view.resolution, row.threads = threads;
    row.work = work, row.unit = unit;
    return row;
  }
  void add(Row row) {
    print_row(row);
    report_.rows.push_back(std::move(row));
  }

  /// Builds with `variant` and with Embree in turn, and leaves the trees. Devices of Embree keep TBB from
  /// giving out all threads, so none lives when a round begins.
  Times race_build(const BuildVariant& variant, int threads) {
    Times times;
    for (Rounds rounds(options_.seconds, 3, options_.runs); rounds.next();) {
      built_ = {};
      embree_.clear();
      on_threads(threads, [&] {
        const double ours = seconds([&] { built_ = build(scene_, variant.options); });
        times.add(ours, each_rival([&](int k) {
                    const double theirs = medium(k).build_seconds();
                    if (k + 1 < kRivals) embree_.clear();
                    return theirs;
                  }));
      });
    }
    return times;
  }

  void build_rows() {
    const BuildVariant& variant = find_variant(options_.build);
    const double count = static_cast<double>(scene_.primitives());
    const bool triangles = scene_.spheres.empty();
    const View none{0, false};
    for (const int threads : options_.threads) {
      if (!options_.wants(Work::build)) break;
      const Times t = race_build(variant, threads);
      Row r = row(none, threads, "build", fmt::format("M{}/s", triangles ? "tri" : "prim"));
      r.oktett = rates(t.oktett, count * 1e-6), r.mode = variant.name + "; medium";
      for (int k = 0; k < kRivals; ++k)
        r.against[k] = {rates(t.embree[k], count * 1e-6), quartiles(t.ratio[k]), ""};
      add(r);
    }
    if (built_.accel == nullptr) built_ = build(scene_, variant.options);
    if (!options_.wants(Work::bytes)) return;
    Row r =
        row(none, options_.threads.front(), triangles ? "bytes per triangle" : "bytes per primitive", "B");
    const double ours = static_cast<double>(built_.bytes) / count;
    r.oktett = quartiles({ours}), r.mode = variant.name + "; medium, both with positions and indices";
    for (int k = 0; k < kRivals; ++k) {
      const double theirs = static_cast<double>(medium(k).bytes()) / count;
      r.against[k] = {quartiles({theirs}), quartiles({ours / theirs}), ""};
    }
    add(r);
  }

  void view_rows(const View& view) {
    const Accel& accel = *built_.accel;
    const Box framed = scene_.framed.empty() ? bounds(accel) : scene_.framed;
    const std::vector<Workload> works = make_workloads(accel, framed, view, options_, isa_);
    for (const Workload& work : works)
      if (options_.wants(work.work) && work.size() > 0) trace_rows(view, work);
    if (options_.wants(Work::equal))
      for (const int threads : options_.threads) equal_row(view, works, threads);
    if (options_.wants(Work::picture) && !scene_.path.empty())
      for (const int threads : options_.threads) picture_row(view, works.front(), threads);
  }

  /// A rival's fastest mode of all.
  EmbreeChoice choose(const Workload& work, int rival) {
    const bool robust = rival == 1, collects = work.query == Query::all;
    return fastest_mode({&embree({1, robust, collects}), &embree({2, robust, collects})}, work);
  }

  /// Traces one batch by Oktett and by the best modes of Embree in turn, on each number of threads.
  void trace_rows(const View& view, const Workload& work) {
    const auto choices = each_rival([&](int k) { return choose(work, k); });
    Answers ours(work), theirs[kRivals]{Answers(work), Answers(work)}, nothing(work);
    std::map<int, Times> times;
    // A single thread does all in this one. Gains over it are of times by the same clock.
    const auto clock = options_.threads == std::vector{1} ? thread_seconds : seconds;
    trace(*built_.accel, work, isa_, 1, ours);
    for (Rounds rounds(options_.seconds, 3, options_.runs); rounds.next();)
      for (const int threads : options_.threads) {
        Times& t = times[threads];
        const double a = clock([&] { trace(*built_.accel, work, isa_, threads, ours); });
        t.add(a, each_rival([&](int k) {
                return clock([&] { trace(*choices[k].scene, choices[k].mode, work, threads, theirs[k]); });
              }));
        t.null.push_back(clock([&] { trace_nothing(work, threads, nothing); }));
      }
    const double n = static_cast<double>(work.size()) * 1e-6;
    for (const int threads : options_.threads) {
      const Times& t = times[threads];
      Row r = row(view, threads, work.name, "Mray/s");
      r.oktett = rates(t.oktett, n), r.null = rates(t.null, n);
      for (int k = 0; k < kRivals; ++k)
        r.against[k] = {rates(t.embree[k], n), quartiles(t.ratio[k]), to_string(choices[k])};
      add(r);
    }
    scaling_rows(view, work, times);
    Agreement agreement{scene_.name, view.inside, view.resolution, to_string(work.work), work.size()};
    for (int k = 0; k < kRivals; ++k) compare(work, ours, theirs[k], k, agreement);
    report_.agreements.push_back(agreement);
    std::erase_if(embree_, [](const auto& scene) { return scene.first.collects; });
  }

  /// Speed on each number of threads relative to the first.
  void scaling_rows(const View& view, const Workload& work, std::map<int, Times>& times) {
    const int first = options_.threads.front();
    const auto gain = [](const std::vector<double>& few, const std::vector<double>& many) {
      std::vector<double> gains;
      for (std::size_t i = 0; i < many.size(); ++i) gains.push_back(few[i] / many[i]);
      return quartiles(gains);
    };
    for (const int threads : options_.threads) {
      if (threads == first) continue;
      const Times &few = times[first], &many = times[threads];
      Row r = row(view, threads, fmt::format("{} threads over {}", threads, first), "times");
      r.oktett = gain(few.oktett, many.oktett), r.null = gain(few.null, many.null);
      r.mode = work.name + "; ratio is that of the gains";
      for (int k = 0; k < kRivals; ++k)
        r.against[k] = {gain(few.embree[k], many.embree[k]), gain(many.ratio[k], few.ratio[k]), ""};
      add(r);
    }
  }

  /// Embree's medium build against the fastest of Oktett's builds whose tree is traced at least as fast.
  void equal_row(const View& view, const std::vector<Workload>& works, int threads) {
    Row r = row(view, threads, "build to equal trace", "s");
    for (Against& against : r.against) against.mode = "no build of Oktett's is traced as fast";
    double best[kRivals];
    std::ranges::fill(best, std::numeric_limits<double>::infinity());
    const OktettScene kept = built_;
    for (const BuildVariant& variant : kBuildVariants) {
      const Times built = race_build(variant, threads), traced = race_traces(works, threads);
      const Quartiles time = quartiles(built.oktett);
      r.parts.emplace_back(variant.name + " build", time.median);
      r.parts.emplace_back(variant.name + " trace", quartiles(traced.oktett).median);
      for (int k = 0; k < kRivals; ++k) {
        const std::string rival = k == 0 ? "embree" : "robust", beside = " beside " + variant.name;
        const double ratio = quartiles(traced.ratio[k]).median;
        r.parts.emplace_back(rival + " trace ratio" + beside, ratio);
        r.parts.emplace_back(rival + " build" + beside, quartiles(built.embree[k]).median);
        r.parts.emplace_back(rival + " trace" + beside, quartiles(traced.embree[k]).median);
        if (ratio < 1 || time.median >= best[k]) continue;
        best[k] = time.median;
        if (k == 0) r.oktett = time;
        r.against[k] = {quartiles(built.embree[k]), quartiles(built.ratio[k]),
                        fmt::format("{}; medium (traces {:.2f})", variant.name, ratio)};
      }
    }
    built_ = kept;
    add(r);
  }

  /// Sums of primary, shadow and diffuse rays in the trees at hand.
  Times race_traces(const std::vector<Workload>& works, int threads) {
    struct Lane {
      const Workload* work;
      std::array<EmbreeMode, kRivals> modes;
      Answers answers;
    };
    std::vector<Lane> lanes;
    for (const Workload& work : works)
      if (work.size() > 0 &&
          (work.work == Work::primary || work.work == Work::shadow || work.work == Work::diffuse))
        lanes.push_back({&work, medium_modes(work), Answers(work)});
    Times times;
    for (Rounds rounds(options_.seconds, 3, options_.runs); rounds.next();) {
      double ours = 0;
      std::array<double, kRivals> theirs{};
      for (Lane& l : lanes) {
        ours += seconds([&] { trace(*built_.accel, *l.work, isa_, threads, l.answers); });
        for (int k = 0; k < kRivals; ++k)
          theirs[k] += seconds([&] { trace(medium(k), l.modes[k], *l.work, threads, l.answers); });
      }
      times.add(ours, theirs);
    }
    return times;
  }

  /// The rivals' fastest modes on trees of medium quality.
  std::array<EmbreeMode, kRivals> medium_modes(const Workload& work) {
    return each_rival([&](int k) { return fastest_mode({&medium(k)}, work).mode; });
  }

  void picture_row(const View& view, const Workload& primary, int threads) {
    const auto modes = medium_modes(primary);
    embree_.clear();
    const PictureTask task{scene_.path, view,   threads, isa_, find_variant(options_.build).options,
                           modes,       config_};
    Row r = row(view, threads, "time to first picture", "s");
    if (race_to_first_picture(task, options_, r)) add(r);
  }

  const PeerScene& scene_;
  const PeerOptions& options_;
  Isa isa_;
  std::string config_;
  PeerReport& report_;
  OktettScene built_;
  std::map<EmbreeKind, std::unique_ptr<EmbreeScene>> embree_;
};

}  // namespace

void compare_scene(const PeerScene& scene, const PeerOptions& options, Isa isa, PeerReport& report) {
  Comparison(scene, options, isa, report).run();
}

}  // namespace oktett::bench
