/// \file The same fields of exact surfaces traced by Oktett and by POV-Ray 3.7, in turn: trace times, and
/// whether both see the same objects.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include "bench/peer_timing.h"
#include "bench/povray_scene.h"
#include "bench/program.h"
#include "io/text/file_content.h"
#include "render/camera.h"
#include "render/geometry.h"
#include "render/picture/render.h"

namespace fs = std::filesystem;

namespace oktett::bench {

namespace {

struct Options {
  std::uint32_t width = 2048, height = 1536;
  int threads = 2, runs = 5;
  std::string json, keep;
  std::vector<std::string> kinds;
};

/// Runs POV-Ray on `scene`.pov in `dir`. Returns the trace time that it reports, in seconds. `bounding`:
/// 1 = its tree of boxes, 2 = its BSP tree.
double run_povray(const fs::path& dir, const std::string& scene, const Options& o, int bounding) {
  const std::string log = (dir / (scene + ".log")).string();
  const std::string command = fmt::format(
      "cd '{}' && povray +I{}.pov +O{}.ppm +FP File_Gamma=1.0 +W{} +H{} -A -D +WT{} +BM{} >{}.log 2>&1",
      dir.string(), scene, scene, o.width, o.height, o.threads, bounding, scene);
  if (std::system(command.c_str()) != 0) throw Error({log, 0, 0}, "POV-Ray failed");
  const std::string text(MappedFile(log).text());
  const std::size_t line = text.find("Trace Time:"), open = text.find('(', line);
  if (line == std::string::npos || open == std::string::npos)
    throw Error({log, 0, 0}, "there is no trace time");
  return std::strtod(text.c_str() + open + 1, nullptr);
}

/// The object numbers that a picture's colours stand for, row by row, mirrored as Oktett's picture is.
std::vector<std::uint32_t> read_ids(const fs::path& path, const Options& o) {
  const MappedFile file(path.string());
  const std::string_view text = file.text();
  const std::size_t size = std::size_t{o.width} * o.height;
  if (text.size() < 3 * size) throw Error({path.string(), 0, 0}, "the picture is too short");
  const auto* pixel = reinterpret_cast<const unsigned char*>(text.data()) + (text.size() - 3 * size);
  std::vector<std::uint32_t> ids(size);
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t from = i - i % o.width + (o.width - 1 - i % o.width);
    ids[i] = pixel[3 * from] | pixel[3 * from + 1] << 8 | pixel[3 * from + 2] << 16;
  }
  return ids;
}

/// The rays through the centres of the pixels.
RayBatch pixel_rays(const Field& field) {
  const CameraFrame camera = camera_frame(field.scene.camera, field.scene.film);
  RayBatch rays;
  for (std::uint32_t y = 0; y < field.scene.film.height; ++y)
    for (std::uint32_t x = 0; x < field.scene.film.width; ++x)
      rays.push_back(camera_ray(camera, x + 0.5, y + 0.5));
  return rays;
}

/// Where the ray first crosses the object, by dense sampling and bisection; infinity if nowhere. Samples may
/// miss parts thinner than a step, so `hint`, a place that may be inside, is sampled too.
long double first_crossing(const FieldObject& object, const Affine& to_world, const Ray& ray,
                           long double hint) {
  const Affine inverse = to_world.inverse();
  const Vec3l o = mapped(inverse, Vec3l(ray.origin)), d = mapped(inverse, Vec3l(ray.direction), 0);
  const long double dd = dot(d, d), middle = -dot(o, d) / dd;
  const Vec3l nearest = o + d * middle;
  // Every object of a field lies within a ball of radius 2.
  const long double h = 4 - dot(nearest, nearest);
  if (h < 0) return HUGE_VALL;
  const long double w = std::sqrt(h / dd);
  constexpr int kSteps = 4096;
  long double t0 = middle - w, f0 = object.f(o + d * t0);
  for (int i = 1; i <= kSteps; ++i) {
    long double t1 = middle - w + 2 * w * i / kSteps, f1 = object.f(o + d * t1);
    if (t0 < hint && hint < t1 && (f0 < 0) == (f1 < 0)) {
      const long double f = object.f(o + d * hint);
      if ((f < 0) != (f0 < 0)) t1 = hint, f1 = f;
    }
    if ((f0 < 0) != (f1 < 0)) return bisected([&](long double t) { return object.f(o + d * t); }, t0, t1);
    t0 = t1, f0 = f1;
  }
  return HUGE_VALL;
}

/// How many pixels show different objects, and which program is right there according to the oracle.
struct Silhouettes {
  std::uint64_t pixels = 0, differ = 0, ours = 0, theirs = 0, neither = 0;
};

Silhouettes compare_ids(const Field& field, const std::vector<std::uint32_t>& theirs) {
  const World world = build_world(field.scene);
  const RayBatch rays = pixel_rays(field);
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  closest_hit(*world.accel, rays.span(), hits.span(), default_isa());
  Silhouettes s;
  s.pixels = rays.size();
  const auto floor = static_cast<std::uint32_t>(field.objects.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    // 0 is the background, object k, which has material k, is k + 1.
    const auto named = [&] {
      if (field.id) return field.id(surface_interaction(*world.accel, rays[i], hits[i]));
      return world.objects[identify(*world.accel, hits[i]).user].material + 1;
    };
    const std::uint32_t ours = hits[i].valid() ? named() : 0;
    if (ours == theirs[i]) continue;
    ++s.differ;
    if (field.right) {
      const std::uint32_t right = field.right(rays[i]);
      ++(ours == right ? s.ours : theirs[i] == right ? s.theirs : s.neither);
      continue;
    }
    // Between the first two crossings that Oktett has found.
    std::vector<Hit> all;
    all_hits(*world.accel, rays[i], all, default_isa());
    const long double hint = all.size() < 2 ? 0 : (static_cast<long double>(all[0].t) + all[1].t) / 2;
    const auto distance = [&](std::uint32_t id) -> long double {
      if (id == 0 || id > floor + 1) return HUGE_VALL;
      if (id == floor + 1) {
        const long double t = -static_cast<long double>(rays[i].origin.y) / rays[i].direction.y;
        return t > 0 ? t : HUGE_VALL;
      }
      return first_crossing(field.objects[id - 1], field.scene.objects[id - 1].transform, rays[i], hint);
    };
    const long double a = distance(ours), b = distance(theirs[i]);
    ++(a < b ? s.ours : b < a ? s.theirs : s.neither);
  }
  return s;
}

struct Row {
  std::string kind;
  Quartiles ours, theirs, ratio;
  int bounding = 1;
  Silhouettes silhouettes;
};

Row compare(const FieldKind& kind, const Options& o, const fs::path& dir) {
  const Field field = kind.name == kTerrainKind ? make_terrain_field(o.width, o.height, dir.string())
                                                : make_field(kind, o.width, o.height);
  write_text((dir / (kind.name + ".pov")).string(), field.pov);
  write_text((dir / (kind.name + "_ids.pov")).string(), field.pov_ids);
  Row row;
  row.kind = kind.name;
  // POV-Ray with the faster of its two structures.
  const double boxes = run_povray(dir, kind.name, o, 1), bsp = run_povray(dir, kind.name, o, 2);
  row.bounding = bsp < boxes ? 2 : 1;
  std::vector<double> ours, theirs, ratio;
  RenderOptions options;
  options.isa = default_isa();
  options.threads = static_cast<unsigned>(o.threads);
  options.data_layers = false;
  for (int run = 0; run < o.runs; ++run) {
    ours.push_back(render(field.scene, options).report.render_seconds);
    theirs.push_back(run_povray(dir, kind.name, o, row.bounding));
    ratio.push_back(theirs.back() / ours.back());
  }
  row.ours = quartiles(ours), row.theirs = quartiles(theirs), row.ratio = quartiles(ratio);
  run_povray(dir, kind.name + "_ids", o, 1);
  row.silhouettes = compare_ids(field, read_ids(dir / (kind.name + "_ids.ppm"), o));
  return row;
}

std::string json_of(const std::vector<Row>& rows) {
  std::string text = "[\n";
  for (const Row& r : rows) {
    const Silhouettes& s = r.silhouettes;
    text += fmt::format(
        "  {{\"kind\": \"{}\", \"oktett_s\": {}, \"povray_s\": {}, \"ratio\": {}, \"ratio_low\": {}, "
        "\"ratio_high\": "
        "{}, \"povray_bounding\": {}, \"pixels\": {}, \"differ\": {}, \"oracle_oktett\": {}, "
        "\"oracle_povray\": {}, "
        "\"oracle_neither\": {}}}{}\n",
        r.kind, r.ours.median, r.theirs.median, r.ratio.median, r.ratio.low, r.ratio.high, r.bounding,
        s.pixels, s.differ, s.ours, s.theirs, s.neither, &r == &rows.back() ? "" : ",");
  }
  return text + "]\n";
}

void parse_size(const std::string& value, Options& o) {
  char rest;
  if (std::sscanf(value.c_str(), "%ux%u%c", &o.width, &o.height, &rest) != 2 || o.width < 1 || o.height < 1 ||
      o.width > 16384 || o.height > 16384)
    throw Error("expected WxH, found '" + value + "'");
}

Options parse(int argc, char** argv) {
  Options o;
  const std::string head =
      "usage: povray_peers [option]... [KIND]...\n  KIND                     one of the kinds of shape; all";
  using Text = const std::string&;
  const std::vector<Option> options = {
      {"--size", "WxH", "2048x1536", [&](Text v) { parse_size(v, o); }},
      {"--threads", "N", "2", [&](Text v) { o.threads = number(v, 1, 1000); }},
      {"--runs", "N", "rounds in which both trace in turn; 5", [&](Text v) { o.runs = number(v, 1, 1000); }},
      {"--json", "FILE", "all figures", [&](Text v) { o.json = v; }},
      {"--keep", "DIR", "leave scenes and pictures there", [&](Text v) { o.keep = v; }}};
  o.kinds = parse_options(argc, argv, head, options);
  const std::vector<FieldKind> kinds = field_kinds();
  for (const std::string& name : o.kinds)
    if (std::ranges::find(kinds, name, &FieldKind::name) == kinds.end())
      throw Error("unknown kind '" + name + "'\n" + usage_text(head, options));
  return o;
}

int run(int argc, char** argv) {
  const Options o = parse(argc, argv);
  const fs::path dir = o.keep.empty()
                           ? fs::temp_directory_path() / fmt::format("oktett-povray-{}", seconds([] {}) * 1e9)
                           : fs::path(o.keep);
  fs::create_directories(dir);
  std::vector<Row> rows;
  fmt::print("{}x{}, {} threads; seconds of tracing, medians of {} rounds in turn\n", o.width, o.height,
             o.threads, o.runs);
  fmt::print("{:<16}{:>9}{:>9}{:>8}{:>16}{:>10}{:>10}{:>8}{:>8}{:>9}\n", "kind", "Oktett", "POV-Ray", "ratio",
             "quarters", "differ", "percent", "ours", "theirs", "neither");
  for (const FieldKind& kind : field_kinds()) {
    if (!o.kinds.empty() && std::find(o.kinds.begin(), o.kinds.end(), kind.name) == o.kinds.end()) continue;
    rows.push_back(compare(kind, o, dir));
    const Row& r = rows.back();
    const Silhouettes& s = r.silhouettes;
    fmt::print("{:<16}{:>9.3f}{:>9.3f}{:>8.2f}{:>16}{:>10}{:>10.4f}{:>8}{:>8}{:>9}\n", r.kind, r.ours.median,
               r.theirs.median, r.ratio.median, fmt::format("{:.2f} to {:.2f}", r.ratio.low, r.ratio.high),
               s.differ, 100.0 * static_cast<double>(s.differ) / static_cast<double>(s.pixels), s.ours,
               s.theirs, s.neither);
    std::fflush(stdout);
  }
  if (!o.json.empty()) write_text(o.json, json_of(rows));
  if (o.keep.empty()) fs::remove_all(dir);
  return 0;
}

}  // namespace

}  // namespace oktett::bench

int main(int argc, char** argv) { return oktett::bench::run_program(oktett::bench::run, argc, argv); }
