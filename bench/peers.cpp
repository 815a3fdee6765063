/// \file Oktett against Embree: the same mesh, the same rays in the same order, runs interleaved, medians of
/// the ratios.
///
///   peers [--resolution N] [--threads N] [--runs N] [--inside] [--isa NAME] [--json FILE] MESH.obj...
///
/// Embree runs in the best of its modes (1, 8 or 16 rays, coherent or not, medium or high build quality);
/// denormals are flushed for both. The null tracer copies the rays and stores misses: the bound that no
/// tracer can pass.

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#if defined(__SSE2__)
#include <pmmintrin.h>
#endif

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "accel/dispatch.h"
#include "bench/bench_rays.h"
#include "bench/embree_peer.h"
#include "core/error.h"
#include "io/obj.h"

namespace oktett::bench {
namespace {

struct Settings {
  View view;
  int threads = 1, runs = 9;
  std::string isa, json;
  std::vector<std::string> meshes;
};

/// One line of the table: rates (higher is better) or sizes (lower is better).
struct Row {
  std::string mesh, work, unit;
  double oktett = 0, embree = 0, null = 0, ratio = 0, spread = 0;
  std::string mode;
};

double seconds(const std::function<void()>& f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v.size() % 2 ? v[v.size() / 2] : 0.5 * (v[v.size() / 2 - 1] + v[v.size() / 2]);
}

void flush_denormals() {
#if defined(__SSE2__)
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
#endif
}

/// Shares a batch out in equal pieces, the same for every rival.
void in_pieces(std::size_t size, const std::function<void(std::size_t, std::size_t)>& f) {
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, size, 4096),
      [&](const tbb::blocked_range<std::size_t>& r) {
        flush_denormals();
        f(r.begin(), r.size());
      },
      tbb::simple_partitioner());
}

/// Everything about one mesh.
class Comparison {
 public:
  Comparison(const std::string& path, const Settings& settings, Isa isa) : settings_(settings), isa_(isa) {
    name_ = path.substr(path.rfind('/') + 1);
    mesh_ = load_obj(path).mesh;
  }

  std::vector<Row> run() {
    build();
    const Box box = bounds(*accel_);
    const RayBatch primary = primary_rays(box, settings_.view);
    HitBatch hits;
    hits.resize_uninitialized(primary.size());
    closest_hit(*accel_, primary.span(), hits.span(), isa_);
    const float radius = 0.5f * length(box.extent());
    const float infinity = std::numeric_limits<float>::infinity();
    trace("primary", primary, false);
    trace("point-light shadow", shadow_rays(*accel_, primary, hits, box, settings_.view), true);
    trace("diffuse", diffuse_rays(*accel_, primary, hits, box, 1, infinity), false);
    trace("ambient occlusion", diffuse_rays(*accel_, primary, hits, box, 4, 0.2f * radius), true);
    return rows_;
  }

 private:
  void build() {
    std::vector<double> ours, theirs, ratios;
    Geometry g;
    g.shape = MeshGeometry{&mesh_};
    const char* config = isa_ == Isa::avx2 ? "isa=avx2" : isa_ == Isa::sse42 ? "isa=sse4.2" : "";
    const int runs = mesh_.triangle_count() > 2000000 ? 3 : settings_.runs;
    for (int i = 0; i < runs; ++i) {
      accel_.reset(), medium_.reset();
      ours.push_back(seconds([&] { accel_ = build_accel({g}); }));
      medium_ = std::make_unique<EmbreeScene>(mesh_, 1, settings_.threads, config);
      theirs.push_back(medium_->build_seconds());
      ratios.push_back(theirs.back() / ours.back());
    }
    high_ = std::make_unique<EmbreeScene>(mesh_, 2, settings_.threads, config);
    const double triangles = static_cast<double>(mesh_.triangle_count());
    add("build", "Mtris/s", triangles / median(ours) * 1e-6, triangles / median(theirs) * 1e-6, 0, ratios,
        "medium");
    const double bytes = static_cast<double>(stats(*accel_).bytes() + mesh_.bytes()) / triangles;
    const double peer = static_cast<double>(medium_->bytes()) / triangles;
    rows_.push_back(
        {name_, "bytes per triangle", "B", bytes, peer, 0, bytes / peer, 0, "medium, with buffers"});
  }

  /// Traces one batch by Oktett and by the best mode of Embree, in turn.
  void trace(const std::string& work, const RayBatch& rays, bool any) {
    const RaySpan span = rays.span();
    HitBatch hits;
    hits.resize_uninitialized(rays.size());
    const HitSpan out = hits.span();
    std::vector<std::uint8_t> occluded(rays.size());
    const auto ours = [&] {
      in_pieces(span.size, [&](std::size_t b, std::size_t n) {
        if (any)
          any_hit(*accel_, span.part(b, n), occluded.data() + b, isa_);
        else
          closest_hit(*accel_, span.part(b, n), out.part(b, n), isa_);
      });
    };
    const auto peer = [&](const EmbreeScene& scene, EmbreeMode mode) {
      in_pieces(span.size, [&](std::size_t b, std::size_t n) {
        if (any)
          scene.any_hit(span.part(b, n), occluded.data() + b, mode);
        else
          scene.closest_hit(span.part(b, n), out.part(b, n), mode);
      });
    };
    const auto null = [&] {
      in_pieces(span.size, [&](std::size_t b, std::size_t n) {
        for (std::size_t i = b; i < b + n; ++i) {
          const Ray r = span[i];
          if (any)
            occluded[i] = r.direction.x > 2;
          else
            out.set(i, {r.tmax, r.origin.x, r.direction.x, kNoId, kNoId});
        }
      });
    };
    const EmbreeScene* scene = nullptr;
    EmbreeMode best_mode;
    double best = std::numeric_limits<double>::infinity();
    for (const EmbreeScene* s : {medium_.get(), high_.get()})
      for (EmbreeMode mode : embree_modes()) {
        peer(*s, mode);
        const double t = std::min(seconds([&] { peer(*s, mode); }), seconds([&] { peer(*s, mode); }));
        if (t < best) best = t, best_mode = mode, scene = s;
      }
    std::vector<double> a, b, c, ratios;
    ours();
    for (int i = 0; i < settings_.runs; ++i) {
      a.push_back(seconds(ours));
      b.push_back(seconds([&] { peer(*scene, best_mode); }));
      c.push_back(seconds(null));
      ratios.push_back(b.back() / a.back());
    }
    const double n = static_cast<double>(rays.size()) * 1e-6;
    add(work, "Mrays/s", n / median(a), n / median(b), n / median(c), ratios,
        fmt::format("{} {}, {}", best_mode.width, best_mode.coherent ? "coherent" : "incoherent",
                    scene == medium_.get() ? "medium" : "high"));
  }

  void add(const std::string& work, const std::string& unit, double oktett, double embree, double null,
           const std::vector<double>& ratios, const std::string& mode) {
    const auto [lo, hi] = std::minmax_element(ratios.begin(), ratios.end());
    rows_.push_back({name_, work, unit, oktett, embree, null, median(ratios), *hi - *lo, mode});
  }

  const Settings& settings_;
  Isa isa_;
  std::string name_;
  TriangleMesh mesh_;
  std::shared_ptr<const Accel> accel_;
  std::unique_ptr<EmbreeScene> medium_, high_;
  std::vector<Row> rows_;
};

Settings parse(int argc, char** argv) {
  Settings s;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    const auto value = [&]() -> std::string {
      if (++i >= argc) throw Error(a + " needs a value");
      return argv[i];
    };
    if (a == "--inside")
      s.view.inside = true;
    else if (a == "--resolution")
      s.view.resolution = std::max(16, std::atoi(value().c_str()) / 16 * 16);
    else if (a == "--threads")
      s.threads = std::max(1, std::atoi(value().c_str()));
    else if (a == "--runs")
      s.runs = std::max(1, std::atoi(value().c_str()));
    else if (a == "--isa")
      s.isa = value();
    else if (a == "--json")
      s.json = value();
    else if (a.starts_with("--"))
      throw Error("unknown option " + a);
    else
      s.meshes.push_back(a);
  }
  if (s.meshes.empty())
    throw Error(
        "usage: peers [--resolution N] [--threads N] [--runs N] [--inside] [--isa NAME] [--json FILE] "
        "MESH.obj...");
  return s;
}

void write_json(const std::string& path, const std::vector<Row>& rows, const Settings& s, Isa isa) {
  std::FILE* f = std::fopen(path.c_str(), "w");
  if (f == nullptr) throw Error({path, 0, 0}, "cannot be written", ErrorKind::io);
  fmt::print(f,
             "{{\"threads\": {}, \"isa\": \"{}\", \"resolution\": {}, \"inside\": {}, \"embree\": \"{}\", "
             "\"rows\": [\n",
             s.threads, to_string(isa), s.view.resolution, s.view.inside, embree_version());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& r = rows[i];
    fmt::print(f,
               "  {{\"mesh\": \"{}\", \"work\": \"{}\", \"unit\": \"{}\", \"oktett\": {}, \"embree\": {}, "
               "\"null\": {}, "
               "\"ratio\": {}, \"spread\": {}, \"embree_mode\": \"{}\"}}{}\n",
               r.mesh, r.work, r.unit, r.oktett, r.embree, r.null, r.ratio, r.spread, r.mode,
               i + 1 < rows.size() ? "," : "");
  }
  fmt::print(f, "]}}\n");
  std::fclose(f);
}

int run(int argc, char** argv) {
  const Settings settings = parse(argc, argv);
  const Isa isa = choose_isa(settings.isa);
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(settings.threads));
  flush_denormals();
  fmt::print("threads {}, {}, {}x{} rays, Embree {}; ratio > 1: Oktett is faster (bytes: < 1 is smaller)\n",
             settings.threads, to_string(isa), settings.view.resolution, settings.view.resolution,
             embree_version());
  fmt::print("{:<24} {:<19} {:>9} {:>9} {:>7} {:>7} {:>9}  {:<8} {}\n", "mesh", "work", "Oktett", "Embree",
             "ratio", "spread", "null", "unit", "Embree's best mode");
  std::vector<Row> rows;
  for (const std::string& path : settings.meshes) {
    for (const Row& r : Comparison(path, settings, isa).run()) {
      fmt::print("{:<24} {:<19} {:>9.2f} {:>9.2f} {:>7.2f} {:>7.2f} {:>9.1f}  {:<8} {}\n", r.mesh, r.work,
                 r.oktett, r.embree, r.ratio, r.spread, r.null, r.unit, r.mode);
      std::fflush(stdout);
      rows.push_back(r);
    }
  }
  if (!settings.json.empty()) write_json(settings.json, rows, settings, isa);
  return 0;
}

}  // namespace
}  // namespace oktett::bench

int main(int argc, char** argv) {
  try {
    return oktett::bench::run(argc, argv);
  } catch (const oktett::Error& e) {
    fmt::print(stderr, "{}\n", e.what());
    return e.kind() == oktett::ErrorKind::io ? 1 : 2;
  }
}
