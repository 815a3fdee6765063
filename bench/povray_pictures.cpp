/// \file Whole pictures by Oktett and by POV-Ray 3.7, in turn: mirrors and glass at equal depth, and lenses
/// and lamps of some size at equal noise.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/peer_timing.h"
#include "bench/povray_picture_scenes.h"
#include "bench/program.h"
#include "io/text/file_content.h"
#include "render/picture/render.h"

namespace fs = std::filesystem;

namespace oktett::bench {
namespace {

struct Options {
  std::uint32_t width = 1024, height = 768;
  int threads = 2, runs = 3;
  std::uint32_t lens_times = 1;
  std::string keep;
  std::vector<std::string> scenes;
};

/// Green of a picture, row by row, how long tracing took and, of Oktett, how many rays were traced.
struct Shot {
  std::vector<float> green;
  double seconds = 0, rays = 0;
};

Shot by_oktett(Scene scene, std::uint32_t samples, const Options& o) {
  IntegratorSettings& settings = scene.integrator;
  (settings.light_samples > 0 ? settings.light_samples : settings.samples) = samples;
  RenderOptions options;
  options.threads = static_cast<unsigned>(o.threads);
  options.data_layers = false;
  options.tile_size = 64;
  const RenderResult result = render(std::move(scene), options);
  const auto& values = result.picture.find("G")->values;
  const RenderReport& r = result.report;
  const auto rays = static_cast<double>(r.camera_rays + r.shadow_rays + r.reflected_rays + r.refracted_rays);
  return {{values.begin(), values.end()}, r.render_seconds, rays};
}

/// POV-Ray's picture, mirrored as its space is. 16 bits a channel, linear.
Shot by_povray(const std::string& text, const Options& o, const fs::path& dir, int bounding) {
  write_text((dir / "scene.pov").string(), text);
  const std::string log = (dir / "scene.log").string();
  const std::string command = fmt::format(
      "cd '{}' && povray +Iscene.pov +Oscene.ppm +FP16 File_Gamma=1.0 +W{} +H{} -A -D +WT{} +BM{} "
      ">scene.log 2>&1",
      dir.string(), o.width, o.height, o.threads, bounding);
  if (std::system(command.c_str()) != 0) throw Error({log, 0, 0}, "POV-Ray failed");
  const std::string report(MappedFile(log).text());
  const std::size_t line = report.find("Trace Time:"), open = report.find('(', line);
  if (line == std::string::npos || open == std::string::npos)
    throw Error({log, 0, 0}, "there is no trace time");
  Shot shot;
  shot.seconds = std::strtod(report.c_str() + open + 1, nullptr);
  const std::string path = (dir / "scene.ppm").string();
  const MappedFile file(path);
  const std::size_t size = std::size_t{o.width} * o.height;
  if (file.text().size() < 6 * size) throw Error({path, 0, 0}, "the picture is too short");
  const auto* pixel =
      reinterpret_cast<const unsigned char*>(file.text().data()) + (file.text().size() - 6 * size);
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t from = i - i % o.width + (o.width - 1 - i % o.width);
    shot.green.push_back(static_cast<float>(pixel[6 * from + 2] << 8 | pixel[6 * from + 3]) / 65535);
  }
  return shot;
}

double mean(const std::vector<float>& v) {
  double sum = 0;
  for (const float x : v) sum += double{x};
  return sum / static_cast<double>(v.size());
}

/// Root mean square of the differences.
double distance(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (double{a[i]} - b[i]) * (double{a[i]} - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

/// The mean over blocks of 32 x 32 pixels of how far their means lie apart, over the mean of the picture.
double block_difference(const std::vector<float>& a, const std::vector<float>& b, const Options& o) {
  constexpr std::uint32_t kEdge = 32;
  double sum = 0;
  int blocks = 0;
  for (std::uint32_t y = 0; y + kEdge <= o.height; y += kEdge)
    for (std::uint32_t x = 0; x + kEdge <= o.width; x += kEdge, ++blocks) {
      double apart = 0;
      for (std::uint32_t k = 0; k < kEdge * kEdge; ++k) {
        const std::size_t i = std::size_t{y + k / kEdge} * o.width + x + k % kEdge;
        apart += double{a[i]} - b[i];
      }
      sum += std::abs(apart) / (kEdge * kEdge);
    }
  return sum / std::max(blocks, 1) / mean(a);
}

/// What both take for a picture, in turn.
struct Times {
  Quartiles ours, theirs, ratio;
};

Times race(const PictureScene& scene, const Options& o, const fs::path& dir, int bounding) {
  std::vector<double> ours, theirs, ratio;
  for (int run = 0; run < o.runs; ++run) {
    ours.push_back(by_oktett(scene.scene, scene.samples, o).seconds);
    theirs.push_back(by_povray(scene.pov(scene.pov_samples), o, dir, bounding).seconds);
    ratio.push_back(theirs.back() / ours.back());
  }
  return {quartiles(ours), quartiles(theirs), quartiles(ratio)};
}

/// Rays per second at six bounces relative to those at one.
Quartiles speed_of_deep_rays(const PictureScene& scene, const Options& o) {
  const auto speed = [&](int depth) {
    Scene at = scene.scene;
    at.integrator.depth = depth;
    const Shot shot = by_oktett(std::move(at), scene.samples, o);
    return shot.rays / shot.seconds;
  };
  std::vector<double> ratio;
  for (int run = 0; run < o.runs; ++run) {
    const double shallow = speed(1);
    ratio.push_back(speed(6) / shallow);
  }
  return quartiles(ratio);
}

void compare(const PictureScene& scene, const Options& o, const fs::path& dir) {
  // POV-Ray with the faster of its two structures.
  const Shot boxes = by_povray(scene.pov(scene.pov_samples), o, dir, 1);
  const Shot bsp = by_povray(scene.pov(scene.pov_samples), o, dir, 2);
  const int bounding = bsp.seconds < boxes.seconds ? 2 : 1;
  const Times times = race(scene, o, dir, bounding);
  Shot ours = by_oktett(scene.scene, scene.samples, o);
  std::string noise = fmt::format("{:>10}{:>10}{:>10}", "", "", "");
  std::vector<float> theirs = boxes.green;
  if (scene.long_samples > 0) {
    const Shot long_ours = by_oktett(scene.scene, scene.long_samples, o);
    const Shot long_theirs = by_povray(scene.pov(scene.pov_long_samples), o, dir, bounding);
    const double a = distance(ours.green, long_ours.green) / mean(long_ours.green);
    const double b = distance(boxes.green, long_theirs.green) / mean(long_theirs.green);
    // The square of the error falls as one over the time.
    noise = fmt::format("{:>10.4f}{:>10.4f}{:>10.1f}", a, b, times.ratio.median * (b * b) / (a * a));
    ours.green = long_ours.green, theirs = long_theirs.green;
  }
  fmt::print("{:<16}{:>9.3f}{:>9.3f}{:>8.2f}{:>16}{}{:>9.2f}{:>9.2f}\n", scene.name, times.ours.median,
             times.theirs.median, times.ratio.median,
             fmt::format("{:.2f} to {:.2f}", times.ratio.low, times.ratio.high), noise,
             100 * (mean(ours.green) / mean(theirs) - 1), 100 * block_difference(theirs, ours.green, o));
  if (scene.mirrors) {
    const Quartiles deep = speed_of_deep_rays(scene, o);
    fmt::print("  rays per second at depth 6 over those at depth 1: {:.3f} ({:.3f} to {:.3f})\n", deep.median,
               deep.low, deep.high);
  }
  std::fflush(stdout);
}

void parse_size(const std::string& value, Options& o) {
  char rest;
  if (std::sscanf(value.c_str(), "%ux%u%c", &o.width, &o.height, &rest) != 2 || o.width < 32 ||
      o.height < 32 || o.width > 16384 || o.height > 16384)
    throw Error("expected WxH of at least 32x32, found '" + value + "'");
}

int run(int argc, char** argv) {
  Options o;
  const std::string head =
      "usage: povray_pictures [option]... [SCENE]...\n  SCENE                    balls_7381, balls_66430, "
      "glass, glass_mesh, lens, lens_mesh or lamp; all";
  using Text = const std::string&;
  const std::vector<Option> options = {
      {"--size", "WxH", "1024x768", [&](Text v) { parse_size(v, o); }},
      {"--threads", "N", "2", [&](Text v) { o.threads = number(v, 1, 1000); }},
      {"--runs", "N", "rounds in which both trace in turn; 3", [&](Text v) { o.runs = number(v, 1, 1000); }},
      {"--lens-times", "N", "N times the samples through lenses; 1",
       [&](Text v) { o.lens_times = number(v, 1u, 64u); }},
      {"--keep", "DIR", "leave the last scene and picture there", [&](Text v) { o.keep = v; }}};
  o.scenes = parse_options(argc, argv, head, options);
  const std::vector<PictureScene> scenes = picture_scenes(o.width, o.height, o.lens_times);
  for (const std::string& name : o.scenes)
    if (std::ranges::find(scenes, name, &PictureScene::name) == scenes.end())
      throw Error("unknown scene '" + name + "'\n" + usage_text(head, options));
  const fs::path dir =
      o.keep.empty() ? fs::temp_directory_path() / fmt::format("oktett-pictures-{}", seconds([] {}) * 1e9)
                     : fs::path(o.keep);
  fs::create_directories(dir);
  fmt::print(
      "{}x{}, {} threads; seconds of tracing, medians of {} rounds in turn; noise over the mean, against "
      "long\n"
      "runs of the same program; percent by which Oktett's mean is greater, and by which blocks differ\n",
      o.width, o.height, o.threads, o.runs);
  fmt::print("{:<16}{:>9}{:>9}{:>8}{:>16}{:>10}{:>10}{:>10}{:>9}{:>9}\n", "scene", "Oktett", "POV-Ray",
             "ratio", "quarters", "our noise", "their", "at equal", "mean", "blocks");
  for (const PictureScene& scene : scenes)
    if (o.scenes.empty() || std::ranges::find(o.scenes, scene.name) != o.scenes.end()) compare(scene, o, dir);
  if (o.keep.empty()) fs::remove_all(dir);
  return 0;
}

}  // namespace
}  // namespace oktett::bench

int main(int argc, char** argv) { return oktett::bench::run_program(oktett::bench::run, argc, argv); }
