/// \file The same mesh scenes path traced by Oktett, by Blender's Cycles and by Embree's pathtracer: whether
/// the pictures agree, and the time that each needs for the same error.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "bench/bench_mesh.h"
#include "bench/path_scenes.h"
#include "bench/peer_timing.h"
#include "bench/program.h"
#include "core/color.h"
#include "io/image/image.h"
#include "io/image/texture.h"
#include "io/mesh/load/load_mesh.h"
#include "io/text/file_content.h"
#include "render/picture/render.h"

namespace fs = std::filesystem;

namespace oktett::bench {

namespace {

/// Pixels along the edge of the blocks whose means are compared.
constexpr std::uint32_t kBlock = 20;
/// Samples of Cycles' short render, whose time is subtracted: it is what loading and building take.
constexpr std::uint32_t kFewSamples = 2;
/// Blocks that differ by more are rendered by Cycles once more, with so many times the samples: where few
/// pixels of a block are lit, its mean is noisy.
constexpr double kSuspicious = 0.02;
constexpr std::uint32_t kMoreSamples = 16;
/// What random numbers begin with in pictures that must not depend on each other.
constexpr std::uint32_t kLongSeed = 7;

struct Options {
  std::uint32_t width = 320, height = 180, samples = 64, long_samples = 1024;
  int threads = 2, runs = 3;
  bool embree = true, cycles = true;
  /// Of timed pictures of Cycles: the noise at which pixels get no more samples; 0: all get as many.
  double adaptive = 0;
  std::string json, keep, mesh = "/usr/share/glmark2/models/bunny.obj";
  std::vector<std::string> scenes;
};

/// The colours of a picture, row by row.
using Pixels = std::vector<Color>;

Pixels pixels_of(const Picture& picture) {
  const PicturePlane* planes[3] = {picture.find("R"), picture.find("G"), picture.find("B")};
  Pixels pixels(std::size_t{picture.width} * picture.height);
  for (int k = 0; k < 3; ++k) {
    if (planes[k] == nullptr) throw Error("the picture has no colours");
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i][k] = planes[k]->values[i];
  }
  return pixels;
}

/// The mean over the pixels of the squared error relative to the light of a pixel; pixels that are darker
/// than a tenth of the picture's mean count as if they had that. `long_samples` and `samples`: by how much
/// the error of the reference itself adds.
double relative_error(const Pixels& found, const Pixels& reference, const Options& o) {
  double mean = 0, sum = 0;
  for (const Color& c : reference) mean += luminance(c);
  mean /= static_cast<double>(reference.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double right = luminance(reference[i]), d = luminance(found[i]) - right;
    sum += d * d / std::pow(std::max(right, 0.1 * mean), 2);
  }
  return sum / static_cast<double>(found.size()) / (1 + static_cast<double>(o.samples) / o.long_samples);
}

/// The means of a block of two pictures.
struct Block {
  std::uint32_t x, y;  ///< of its first pixel
  double ours, theirs;
  double difference() const { return std::abs(ours - theirs) / theirs; }
};

double block_mean(const Pixels& pixels, std::uint32_t width, std::uint32_t x, std::uint32_t y) {
  double sum = 0;
  for (std::uint32_t k = 0; k < kBlock * kBlock; ++k)
    sum += luminance(pixels[std::size_t{y + k / kBlock} * width + x + k % kBlock]);
  return sum / (kBlock * kBlock);
}

std::vector<Block> blocks_of(const Pixels& ours, const Pixels& theirs, const Options& o) {
  std::vector<Block> blocks;
  for (std::uint32_t y = 0; y + kBlock <= o.height; y += kBlock)
    for (std::uint32_t x = 0; x + kBlock <= o.width; x += kBlock)
      blocks.push_back({x, y, block_mean(ours, o.width, x, y), block_mean(theirs, o.width, x, y)});
  return blocks;
}

/// How two pictures differ by the means of blocks, relative to the second: quarter points over the blocks
/// that are not dark, and the greatest.
struct BlockDifference {
  double median = 0, ninety = 0, greatest = 0, whole = 0;
  int repeated = 0;  ///< blocks that were rendered once more
};

/// `repeat(block)` is the second mean of a block with more samples.
template <class Repeat>
BlockDifference compare_blocks(const std::vector<Block>& blocks, Repeat&& repeat) {
  BlockDifference found;
  double ours = 0, theirs = 0;
  for (const Block& b : blocks) ours += b.ours, theirs += b.theirs;
  found.whole = ours / theirs - 1;
  std::vector<double> differences;
  for (Block b : blocks) {
    if (!(b.theirs > 0.02 * theirs / static_cast<double>(blocks.size()))) continue;
    if (b.difference() > kSuspicious) b.theirs = repeat(b), ++found.repeated;
    differences.push_back(b.difference());
  }
  std::ranges::sort(differences);
  if (differences.empty()) throw Error("the picture is black");
  const auto at = [&](double part) {
    return differences[static_cast<std::size_t>(part * static_cast<double>(differences.size() - 1))];
  };
  found.median = at(0.5), found.ninety = at(0.9), found.greatest = at(1);
  return found;
}

/// A picture, and the seconds of tracing it.
struct Traced {
  Picture picture;
  double seconds = 0;
};

/// `textures` are those of the scene. They read a picture when it is first asked for.
Traced trace(Scene scene, const ImageTextures& textures, std::uint32_t samples, std::uint32_t seed,
             const Options& o) {
  RenderOptions options;
  options.textures = &textures;
  options.threads = static_cast<unsigned>(o.threads), options.data_layers = false;
  scene.integrator.samples = samples, scene.integrator.seed = seed;
  RenderResult result = render(std::move(scene), options);
  return {std::move(result.picture), result.report.render_seconds};
}

void run_command(const std::string& command, const std::string& log) {
  if (std::system((command + " >'" + log + "' 2>&1").c_str()) != 0)
    throw Error({log, 0, 0}, "the program failed");
}

/// The number that follows `word` in a program's output.
double number_after(const std::string& log, const std::string& word) {
  const std::string text(MappedFile(log).text());
  const std::size_t at = text.find(word);
  if (at == std::string::npos) throw Error({log, 0, 0}, "there is no '" + word + "'");
  return std::strtod(text.c_str() + at + word.size(), nullptr);
}

/// `variables`: more of the environment.
std::string cycles_command(const fs::path& dir, std::uint32_t seed, const Options& o,
                           const std::string& variables = {}) {
  return fmt::format("OKTETT_PEER_THREADS={} {} blender -b --factory-startup -P '{}' -- '{}' {}", o.threads,
                     variables, OKTETT_BLENDER_SCRIPT, dir.string(), seed);
}

/// Renders with Cycles. Returns the seconds of `samples` samples, without those of loading and building.
double run_cycles(const fs::path& dir, std::uint32_t samples, std::uint32_t seed, const Options& o,
                  const std::string& variables = {}) {
  const std::string log = (dir / "cycles.log").string();
  run_command(fmt::format("{} {} {}", cycles_command(dir, seed, o, variables), kFewSamples, samples), log);
  const double few = number_after(log, fmt::format("cycles {} ", kFewSamples));
  const double all = number_after(log, fmt::format("cycles {} ", samples));
  return (all - few) * samples / (samples - kFewSamples);
}

struct CyclesRow {
  Quartiles ours, theirs;  ///< seconds
  double our_error = 0, their_error = 0;
  BlockDifference blocks;
  double equal_error_ratio() const { return theirs.median * their_error / (ours.median * our_error); }
};

CyclesRow against_cycles(const PathScene& scene, const fs::path& dir, const Options& o) {
  const Scene here = oktett_scene(scene, o.width, o.height, dir.string());
  // The long picture has them read all, as the time of Cycles' few samples is subtracted.
  const ImageTextures textures(here.textures);
  const auto picture = [&](std::uint32_t samples) {
    return pixels_of(read_image((dir / fmt::format("cycles_{}.exr", samples)).string()));
  };
  CyclesRow row;
  const Picture long_picture = trace(here, textures, o.long_samples, kLongSeed, o).picture;
  write_image((dir / fmt::format("oktett_{}.exr", o.long_samples)).string(), long_picture);
  const Pixels our_long = pixels_of(long_picture);
  run_cycles(dir, o.long_samples, kLongSeed, o);
  const Pixels their_long = picture(o.long_samples);
  row.blocks = compare_blocks(blocks_of(our_long, their_long, o), [&](const Block& b) {
    const std::uint32_t samples = kMoreSamples * o.long_samples;
    const std::string part =
        fmt::format("OKTETT_PEER_PART='{} {} {} {}'", b.x, b.y, b.x + kBlock, b.y + kBlock);
    run_command(fmt::format("{} {}", cycles_command(dir, kLongSeed, o, part), samples),
                (dir / "cycles.log").string());
    return block_mean(picture(samples), o.width, b.x, b.y);
  });
  const std::string adaptive = o.adaptive > 0 ? fmt::format("OKTETT_PEER_ADAPTIVE={}", o.adaptive) : "";
  std::vector<double> ours, theirs;
  for (int run = 0; run < o.runs; ++run) {
    const Traced traced = trace(here, textures, o.samples, 0, o);
    ours.push_back(traced.seconds);
    row.our_error = relative_error(pixels_of(traced.picture), our_long, o);
    theirs.push_back(run_cycles(dir, o.samples, 0, o, adaptive));
  }
  row.their_error = relative_error(picture(o.samples), their_long, o);
  row.ours = quartiles(ours), row.theirs = quartiles(theirs);
  return row;
}

/// The model over ground under light from all around: what Embree's pathtracer knows as ambient light.
PathScene open_scene(const PathScene& outside) {
  PathScene scene = outside;
  scene.name = "open";
  scene.environment = nullptr;
  scene.background = {1, 1, 1};
  return scene;
}

struct EmbreeRow {
  Quartiles ours, theirs;  ///< millions of samples per second
  Quartiles ratio;
};

EmbreeRow against_embree(const PathScene& scene, const fs::path& dir, const Options& o) {
  constexpr std::uint32_t kWidth = 960, kHeight = 540, kSamples = 8;
  constexpr int kFrames = 3;
  const Scene here = oktett_scene(scene, kWidth, kHeight, dir.string());
  const ImageTextures textures(here.textures);
  const std::string log = (dir / "embree.log").string();
  const Camera& c = scene.camera;
  const std::string command = fmt::format(
      "pathtracer -i '{}' --ambientlight 1 1 1 --size {} {} --spp {} --max-path-length {} --threads {} "
      "--vp {} {} {} --vi {} {} {} --vu 0 1 0 --fov {} --benchmark 1 {} -o '{}'",
      (dir / "scene.obj").string(), kWidth, kHeight, kSamples, scene.depth + 1, o.threads, c.from.x, c.from.y,
      c.from.z, c.at.x, c.at.y, c.at.z, c.fov, kFrames, (dir / "embree.ppm").string());
  std::vector<double> ours, theirs, ratio;
  for (int run = 0; run < o.runs; ++run) {
    const double samples = 1e-6 * kWidth * kHeight * kSamples;
    ours.push_back(kFrames * samples / trace(here, textures, kSamples * kFrames, 0, o).seconds);
    run_command(command, log);
    theirs.push_back(samples * number_after(log, "BENCHMARK_RENDER_AVG "));
    ratio.push_back(ours.back() / theirs.back());
  }
  return {quartiles(ours), quartiles(theirs), quartiles(ratio)};
}

void parse_size(const std::string& value, Options& o) {
  char rest;
  if (std::sscanf(value.c_str(), "%ux%u%c", &o.width, &o.height, &rest) != 2 || o.width < kBlock ||
      o.height < kBlock || o.width > 4096 || o.height > 4096)
    throw Error("expected WxH, found '" + value + "'");
}

Options parse(int argc, char** argv) {
  Options o;
  using Text = const std::string&;
  const std::vector<Option> options = {
      {"--size", "WxH", "of pictures compared with Cycles; 320x180", [&](Text v) { parse_size(v, o); }},
      {"--spp", "N", "samples of the pictures that are timed; 64",
       [&](Text v) { o.samples = number(v, 4u, 65536u); }},
      {"--long-spp", "N", "samples of the references; 1024",
       [&](Text v) { o.long_samples = number(v, 4u, 65536u); }},
      {"--adaptive", "NOISE",
       "at which Cycles gives a timed pixel no more samples, as 0.01; none: all get as many",
       [&](Text v) { o.adaptive = number(v, 0.0, 1.0); }},
      {"--threads", "N", "2", [&](Text v) { o.threads = number(v, 1, 1000); }},
      {"--runs", "N", "rounds in which all trace in turn; 3", [&](Text v) { o.runs = number(v, 1, 1000); }},
      {"--mesh", "OBJ", "the model; glmark2's bunny", [&](Text v) { o.mesh = v; }},
      {"--no-embree", "", "Cycles alone", [&](Text) { o.embree = false; }},
      {"--no-cycles", "", "Embree's pathtracer alone", [&](Text) { o.cycles = false; }},
      {"--json", "FILE", "all figures", [&](Text v) { o.json = v; }},
      {"--keep", "DIR", "leave scenes and pictures there", [&](Text v) { o.keep = v; }}};
  o.scenes =
      parse_options(argc, argv,
                    "usage: path_peers [option]... [SCENE]...\n"
                    "  SCENE                    of those for Cycles; all but `textures`, which takes 5 GB",
                    options);
  return o;
}

bool has_program(const char* name) {
  return std::system(fmt::format("command -v {} >/dev/null", name).c_str()) == 0;
}

std::string cycles_json(const std::string& name, const CyclesRow& r) {
  return fmt::format(
      "  {{\"scene\": \"{}\", \"oktett_s\": {}, \"cycles_s\": {}, \"oktett_error\": {}, \"cycles_error\": "
      "{}, "
      "\"equal_error_ratio\": {}, \"blocks_median\": {}, \"blocks_ninety\": {}, \"blocks_greatest\": {}, "
      "\"whole\": {}, \"blocks_repeated\": {}}}",
      name, r.ours.median, r.theirs.median, r.our_error, r.their_error, r.equal_error_ratio(),
      r.blocks.median, r.blocks.ninety, r.blocks.greatest, r.blocks.whole, r.blocks.repeated);
}

void compare_cycles(const std::vector<PathScene>& scenes, const fs::path& dir, const Options& o,
                    std::vector<std::string>& json) {
  fmt::print(
      "Cycles, {}x{}, {} samples, {} threads: seconds, relative squared error against {} samples, ratio of "
      "times at "
      "equal error; differences of blocks of {} x {} pixels, and how many were rendered by Cycles once more "
      "with {} times the samples\n",
      o.width, o.height, o.samples, o.threads, o.long_samples, kBlock, kBlock, kMoreSamples);
  fmt::print("{:<12}{:>9}{:>9}{:>11}{:>11}{:>8}{:>9}{:>9}{:>9}{:>9}{:>7}\n", "scene", "Oktett", "Cycles",
             "error", "error", "ratio", "median", "90 %", "most", "whole", "again");
  for (const PathScene& scene : scenes) {
    const fs::path place = dir / scene.name;
    fs::create_directories(place);
    write_path_scene(scene, o.width, o.height, place.string());
    const CyclesRow r = against_cycles(scene, place, o);
    fmt::print("{:<12}{:>9.2f}{:>9.2f}{:>11.2e}{:>11.2e}{:>8.2f}{:>8.2f}%{:>8.2f}%{:>8.2f}%{:>8.2f}%{:>7}\n",
               scene.name, r.ours.median, r.theirs.median, r.our_error, r.their_error, r.equal_error_ratio(),
               100 * r.blocks.median, 100 * r.blocks.ninety, 100 * r.blocks.greatest, 100 * r.blocks.whole,
               r.blocks.repeated);
    std::fflush(stdout);
    json.push_back(cycles_json(scene.name, r));
  }
}

int run(int argc, char** argv) {
  const Options o = parse(argc, argv);
  const fs::path dir = o.keep.empty()
                           ? fs::temp_directory_path() / fmt::format("oktett-paths-{}", seconds([] {}) * 1e9)
                           : fs::path(o.keep);
  fs::create_directories(dir);
  const TriangleMesh model = fs::exists(o.mesh) ? load_mesh(o.mesh).mesh : bench_mesh();
  std::vector<PathScene> scenes = path_scenes(model);
  const auto chosen = [&](const std::string& name) {
    return std::ranges::find(o.scenes, name) != o.scenes.end();
  };
  const PathScene open = open_scene(*std::ranges::find(scenes, "environment", &PathScene::name));
  if (!o.scenes.empty()) std::erase_if(scenes, [&](const PathScene& s) { return !chosen(s.name); });
  if (chosen("textures")) scenes.push_back(textured_scene());
  std::vector<std::string> json;
  if (o.cycles && !has_program("blender"))
    fmt::print("there is no blender; scripts/setup --bench installs it\n");
  else if (o.cycles)
    compare_cycles(scenes, dir, o, json);
  if (o.embree && !has_program("pathtracer")) {
    fmt::print("there is no pathtracer; scripts/setup --bench installs it\n");
  } else if (o.embree) {
    const fs::path place = dir / open.name;
    fs::create_directories(place);
    write_path_scene(open, 960, 540, place.string());
    const EmbreeRow r = against_embree(open, place, o);
    fmt::print("Embree's pathtracer: {:.2f} Msamples/s, Oktett {:.2f}, ratio {:.2f} ({:.2f} to {:.2f})\n",
               r.theirs.median, r.ours.median, r.ratio.median, r.ratio.low, r.ratio.high);
    json.push_back(fmt::format(
        "  {{\"scene\": \"open\", \"oktett_msamples\": {}, \"embree_msamples\": {}, \"ratio\": {}}}",
        r.ours.median, r.theirs.median, r.ratio.median));
  }
  if (!o.json.empty()) write_text(o.json, fmt::format("[\n{}\n]\n", fmt::join(json, ",\n")));
  if (o.keep.empty()) fs::remove_all(dir);
  return 0;
}

}  // namespace

}  // namespace oktett::bench

int main(int argc, char** argv) { return oktett::bench::run_program(oktett::bench::run, argc, argv); }
