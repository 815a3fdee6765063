/// \file Oktett against Embree: the same mesh, the same rays in the same order, runs interleaved, medians of
/// the ratios. `peers` without arguments lists its options.
///
/// Embree runs in the best of its modes (1, 8 or 16 rays, coherent or not, medium or high build quality);
/// denormals are flushed for both.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "bench/bench_rays.h"
#include "bench/embree_peer.h"
#include "bench/peer_options.h"
#include "bench/peer_picture.h"
#include "bench/peer_table.h"
#include "bench/peer_timing.h"
#include "bench/peer_trace.h"
#include "bench/program.h"
#include "io/obj/obj.h"

namespace oktett::bench {
namespace {

/// A way of building a tree.
struct BuildVariant {
  std::string name;
  BuildOptions options;
};

/// All that the comparison measures; the first is Oktett's default.
const BuildVariant kBuildVariants[] = {
    {"balanced", {BuildQuality::balanced}}, {"fast", {BuildQuality::fast}}, {"best", {BuildQuality::best}}};

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

/// Seconds that the same work took Oktett, Embree and the null tracer, in turn.
struct Times {
  std::vector<double> oktett, embree, null, ratio;
  void add(double ours, double theirs) {
    oktett.push_back(ours), embree.push_back(theirs), ratio.push_back(theirs / ours);
  }
};

/// All rows of one mesh.
class Comparison {
 public:
  Comparison(std::string path, const PeerOptions& options, Isa isa, PeerReport& report)
      : path_(std::move(path)), options_(options), isa_(isa), config_(embree_config(isa)), report_(report) {
    name_ = path_.substr(path_.rfind('/') + 1);
    mesh_ = load_obj(path_).mesh;
  }

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
  std::shared_ptr<const Accel> build(const BuildVariant& variant) const {
    return build_accel({{MeshGeometry{&mesh_}, {}}}, variant.options);
  }
  std::unique_ptr<EmbreeScene> embree_build(int quality) const {
    return std::make_unique<EmbreeScene>(mesh_, quality, config_.c_str());
  }

  /// Embree's trees, made when they are first needed.
  const EmbreeScene* medium() { return (medium_ ? medium_ : medium_ = embree_build(1)).get(); }
  const EmbreeScene* high() { return (high_ ? high_ : high_ = embree_build(2)).get(); }
  /// Their devices keep TBB from giving out all threads.
  void forget_embree() { medium_.reset(), high_.reset(); }

  Row row(const View& view, int threads, const std::string& work, const std::string& unit) const {
    Row row;
    row.mesh = name_, row.inside = view.inside, row.resolution = view.resolution, row.threads = threads;
    row.work = work, row.unit = unit;
    return row;
  }
  void add(Row row) {
    print_row(row);
    report_.rows.push_back(std::move(row));
  }

  /// Builds with `variant` and with Embree in turn, and leaves both trees.
  Times race_build(const BuildVariant& variant, int threads) {
    Times times;
    for (Rounds rounds(options_.seconds, 3, options_.runs); rounds.next();) {
      accel_.reset();
      forget_embree();
      on_threads(threads, [&] {
        const double ours = seconds([&] { accel_ = build(variant); });
        times.add(ours, medium()->build_seconds());
      });
    }
    return times;
  }

  void build_rows() {
    const double triangles = static_cast<double>(mesh_.triangle_count());
    const BuildVariant& variant = find_variant(options_.build);
    const View none{0, false};
    for (const int threads : options_.threads) {
      if (!options_.wants(Work::build)) break;
      const Times t = race_build(variant, threads);
      Row r = row(none, threads, "build", "Mtri/s");
      r.oktett = rates(t.oktett, triangles * 1e-6), r.embree = rates(t.embree, triangles * 1e-6);
      r.ratio = quartiles(t.ratio), r.mode = variant.name + "; medium";
      add(r);
    }
    if (accel_ == nullptr) accel_ = build(variant);
    if (!options_.wants(Work::bytes)) return;
    // Embree gets positions and indices only, so our normals and uvs are not counted.
    const std::size_t buffers =
        mesh_.positions.size() * sizeof(mesh_.positions[0]) + mesh_.indices.size() * sizeof(mesh_.indices[0]);
    const double ours = static_cast<double>(stats(*accel_).bytes() + buffers) / triangles;
    const double theirs = static_cast<double>(medium()->bytes()) / triangles;
    Row r = row(none, options_.threads.front(), "bytes per triangle", "B");
    r.oktett = quartiles({ours}), r.embree = quartiles({theirs}), r.ratio = quartiles({ours / theirs});
    r.mode = variant.name + "; medium, both with positions and indices";
    add(r);
  }

  void view_rows(const View& view) {
    const std::vector<Workload> works = make_workloads(*accel_, view, options_, isa_);
    for (const Workload& work : works)
      if (options_.wants(work.work) && work.rays.size() > 0) trace_rows(view, work);
    if (options_.wants(Work::equal))
      for (const int threads : options_.threads) equal_row(view, works, threads);
    if (options_.wants(Work::picture))
      for (const int threads : options_.threads) picture_row(view, works.front(), threads);
  }

  /// Traces one batch by Oktett and by the best mode of Embree in turn, on each number of threads.
  void trace_rows(const View& view, const Workload& work) {
    const EmbreeChoice choice = fastest_mode({medium(), high()}, work);
    Answers ours(work), theirs(work), nothing(work);
    std::map<int, Times> times;
    trace(*accel_, work, isa_, 1, ours);
    for (Rounds rounds(options_.seconds, 3, options_.runs); rounds.next();)
      for (const int threads : options_.threads) {
        Times& t = times[threads];
        const double a = seconds([&] { trace(*accel_, work, isa_, threads, ours); });
        t.add(a, seconds([&] { trace(*choice.scene, choice.mode, work, threads, theirs); }));
        t.null.push_back(seconds([&] { trace_nothing(work, threads, nothing); }));
      }
    const double n = static_cast<double>(work.rays.size()) * 1e-6;
    for (const int threads : options_.threads) {
      const Times& t = times[threads];
      Row r = row(view, threads, work.name, "Mray/s");
      r.oktett = rates(t.oktett, n), r.embree = rates(t.embree, n), r.null = rates(t.null, n);
      r.ratio = quartiles(t.ratio);
      r.mode = to_string(choice.mode) + (choice.scene == medium() ? ", medium" : ", high");
      add(r);
    }
    scaling_rows(view, work, times);
    Agreement agreement = compare(work, ours, theirs);
    agreement.mesh = name_, agreement.inside = view.inside, agreement.resolution = view.resolution;
    report_.agreements.push_back(agreement);
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
      r.oktett = r.ratio = gain(few.oktett, many.oktett), r.embree = gain(few.embree, many.embree);
      r.null = gain(few.null, many.null), r.mode = work.name + "; ratio is Oktett's gain";
      add(r);
    }
  }

  /// Embree's medium build against the fastest of Oktett's builds whose tree is traced at least as fast.
  void equal_row(const View& view, const std::vector<Workload>& works, int threads) {
    Row r = row(view, threads, "build to equal trace", "s");
    r.mode = "no build of Oktett's is traced as fast";
    double best = std::numeric_limits<double>::infinity();
    const std::shared_ptr<const Accel> kept = accel_;
    for (const BuildVariant& variant : kBuildVariants) {
      const Times built = race_build(variant, threads), traced = race_traces(works, threads);
      const Quartiles time = quartiles(built.oktett), trace_ratio = quartiles(traced.ratio);
      r.parts.emplace_back(variant.name + " build", time.median);
      r.parts.emplace_back(variant.name + " trace", quartiles(traced.oktett).median);
      r.parts.emplace_back(variant.name + " trace ratio", trace_ratio.median);
      r.parts.emplace_back("embree build beside " + variant.name, quartiles(built.embree).median);
      r.parts.emplace_back("embree trace beside " + variant.name, quartiles(traced.embree).median);
      if (trace_ratio.median < 1 || time.median >= best) continue;
      best = time.median;
      r.oktett = time, r.embree = quartiles(built.embree), r.ratio = quartiles(built.ratio);
      r.mode = fmt::format("{}; medium (traces {:.2f})", variant.name, trace_ratio.median);
    }
    accel_ = kept;
    add(r);
  }

  /// Sums of primary, shadow and diffuse rays in the trees at hand.
  Times race_traces(const std::vector<Workload>& works, int threads) {
    struct Lane {
      const Workload* work;
      EmbreeMode mode;
      Answers answers;
    };
    std::vector<Lane> lanes;
    for (const Workload& work : works)
      if (work.work != Work::ambient_occlusion && work.rays.size() > 0)
        lanes.push_back({&work, fastest_mode({medium()}, work).mode, Answers(work)});
    Times times;
    for (Rounds rounds(options_.seconds, 3, options_.runs); rounds.next();) {
      double ours = 0, theirs = 0;
      for (Lane& l : lanes) {
        ours += seconds([&] { trace(*accel_, *l.work, isa_, threads, l.answers); });
        theirs += seconds([&] { trace(*medium(), l.mode, *l.work, threads, l.answers); });
      }
      times.add(ours, theirs);
    }
    return times;
  }

  void picture_row(const View& view, const Workload& primary, int threads) {
    PictureTask task{path_, view, threads, isa_, find_variant(options_.build).options, {}, config_};
    task.mode = fastest_mode({medium()}, primary).mode;
    forget_embree();
    Row r = row(view, threads, "time to first picture", "s");
    if (race_to_first_picture(task, options_, r)) add(r);
  }

  std::string path_, name_;
  const PeerOptions& options_;
  Isa isa_;
  std::string config_;
  PeerReport& report_;
  TriangleMesh mesh_;
  std::shared_ptr<const Accel> accel_;
  std::unique_ptr<EmbreeScene> medium_, high_;
};

int run(int argc, char** argv) {
  const PeerOptions options = parse_peer_options(argc, argv);
  const Isa isa = choose_isa(options.isa);
  flush_denormals();
  print_header(options, to_string(isa));
  PeerReport report;
  for (const std::string& path : options.meshes) Comparison(path, options, isa, report).run();
  if (!options.json.empty()) write_json(options.json, report, to_string(isa));
  return 0;
}

}  // namespace
}  // namespace oktett::bench

int main(int argc, char** argv) { return oktett::bench::run_program(oktett::bench::run, argc, argv); }
