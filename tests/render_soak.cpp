/// \file Renders thousands of changing scenes in one process, with errors in between, and watches the memory
/// and the open files of the process. Prints a table over time; exit status 1 if either grows.
///
///     render_soak [--renders N] [--seed N] [--errors 1]

#include <dirent.h>
#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/cache/scene_cache.h"
#include "io/image/image.h"
#include "io/image/texture.h"
#include "io/photon/photon_map_file.h"
#include "io/scene/scene_file.h"
#include "io/scene/write_scene.h"
#include "render/film/denoise.h"
#include "render/look/default_look.h"
#include "render/picture/render.h"
#include "tests/support/sanitizers.h"
#include "tests/support/temp_dir.h"
#include "verify/oracles/known_shapes.h"

namespace oktett::test {
namespace {

namespace fs = std::filesystem;

constexpr bool kWatchesMemory = !kSanitized;  // sanitizers keep what was freed, and find leaks by themselves

std::size_t open_files() {
  std::size_t count = 0;
  DIR* const folder = opendir("/proc/self/fd");
  if (folder == nullptr) return 0;
  while (readdir(folder) != nullptr) ++count;
  closedir(folder);
  return count - 3;  // ".", ".." and the folder itself
}

/// Resident memory in bytes.
std::size_t resident() {
  std::ifstream file("/proc/self/statm");
  std::size_t all = 0, pages = 0;
  file >> all >> pages;
  return pages * 4096;
}

/// Bytes that were allocated and not freed.
std::size_t allocated() {
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

std::string wavy_mesh(CaseRandom& r) {
  const int n = 3 + static_cast<int>(r.bits() % 40);
  std::string text = "mtllib m.mtl\nusemtl a\n";
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      text += fmt::format("v {} {} {}\nvt {} {}\n", 2.0 * i / n - 1, 0.2 * r.sign(), 2.0 * j / n - 1,
                          double(i) / n, double(j) / n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i + 1;
      text += fmt::format("f {0}/{0} {1}/{1} {2}/{2} {3}/{3}\n", a, a + n + 1, a + n + 2, a + 1);
    }
  return text;
}

/// A scene with a mesh, textures, lights of all kinds, motion, smoke, instances and a combination.
std::string scene_text(CaseRandom& r) {
  return fmt::format(
      R"(oktett: 1
film: {{width: 20, height: 14, cryptomatte: {0}}}
integrator: {{samples: {1}, depth: 4, light_samples: 2{2}}}
camera: {{from: [0, 2, 5], at: [0, 0, 0], shutter: {3}}}
media: {{fog: {{scattering: [{4}, {4}, {4}]}}}}
materials:
  lamp: {{emission: [4, 4, 4], light_group: lamp}}
  glass: {{transparency: 0.9, reflection: 0.1, interior: fog}}
  pattern: {{color: {{checker: {{colors: [[1, 0, 0], [0, 0, {5}]]}}}}}}
lights:
  - point: {{position: [3, 4, {6}], color: [0.5, 0.5, 0.5]}}
  - sky: {{sun: [1, 2, {7}]}}
define:
  ball: {{sphere: {{radius: {8}}}}}
objects:
  - {{mesh: {{file: m.obj}}}}
  - {{sphere: {{center: [0, 2, 0], radius: 0.2}}, material: lamp}}
  - {{torus: {{major: 0.7, minor: {9}}}, material: glass}}
  - {{instance: ball, transform: {{translate: [1, 0, 0]}}}}
  - {{instance: ball, material: pattern, transform: {{translate: [-1, {10}, 0]}}}}
)",
      r.bits() % 2 == 0, 1 + r.bits() % 3, r.bits() % 3 == 0 ? ", error: 0.3, max_samples: 8" : "", "[0, 1]",
      0.1 + r.unit(), r.unit(), r.sign(), r.sign(), 0.2 + 0.2 * r.unit(), 0.1 + 0.2 * r.unit(), r.sign());
}

/// Scenes that cannot be loaded, one kind of mistake after the other.
constexpr const char* kBroken[] = {
    "oktett: 1\nobjects: [{mesh: {file: gone.obj}}]\n",
    "oktett: 1\nobjects: [{mesh: {file: bad.obj}}]\n",
    "oktett: 1\nobjects: [{sphere: {radius: ]\n",
    "oktett: 1\nobjects: [{sphere: {radius: -1}}]\n",
    "oktett: 1\ninclude: [gone.yaml]\n",
    "oktett: 1\nobjects: [{implicit: {function: 'x +', bounds: [[-1, -1, -1], [1, 1, 1]]}}]\n",
    "oktett: 1\nlights: [{environment: {file: bad.exr}}]\n",
    "oktett: 1\nobjects: [{height_field: {file: bad.png}}]\n"};

class Soak {
 public:
  Soak(std::uint64_t seed, bool shows) : seed_(seed), shows_(shows) {
    for (const auto& entry : fs::directory_iterator(fs::path(OKTETT_SOURCE_DIR) / "scenes"))
      if (entry.path().extension() == ".yaml") examples_.push_back(entry.path().string());
    std::ranges::sort(examples_);
    dir_.write("bad.obj", "v 0 0 0\nf 1 2 3\n");
    for (const char* name : {"bad.exr", "bad.png", "bad.photons"}) dir_.write(name, "nothing");
    dir_.write("m.mtl", "newmtl a\nmap_Kd checker.png\nmap_Bump bad.png\n");
    fs::copy_file(fs::path(OKTETT_SOURCE_DIR) / "scenes/assets/checker.png", dir_.file("checker.png"));
  }

  /// Render number `i`; errors are what some scenes are made for.
  void run(std::uint64_t i) {
    CaseRandom r((seed_ << 32) + i);
    try {
      Scene scene = make(i, r);
      scene.integrator.kind = kIntegratorKinds[i / 5 % std::size(kIntegratorKinds)].value;
      render_scene(std::move(scene), i, r);
    } catch (const Error& error) {
      ++errors;
      if (shows_) fmt::print("{}: {}\n", i, error.what());
    }
  }

  std::uint64_t pictures = 0, errors = 0;

 private:
  Scene make(std::uint64_t i, CaseRandom& r) {
    switch (i % 5) {
      case 0: {
        Scene scene = load_scene(examples_[i / 5 % examples_.size()]);
        scene.film.width = 16, scene.film.height = 12;
        scene.integrator.samples = 1, scene.integrator.error = 0;
        return scene;
      }
      case 1:
        return through_file(draw_scene(i));
      case 2: {
        dir_.write("m.obj", wavy_mesh(r));
        Scene scene = load_scene(dir_.file("m.obj"));
        scene.film.width = 16, scene.film.height = 12;
        if (i % 2 == 0)
          apply_look(scene, static_cast<Look>(r.bits() % 4), static_cast<Viewpoint>(r.bits() % 3));
        scene.integrator.samples = 1;
        return scene;
      }
      case 3:
        return load_scene(dir_.write("broken.yaml", kBroken[i / 5 % std::size(kBroken)]));
      default:
        dir_.write("m.obj", wavy_mesh(r));
        return load_scene(dir_.write("a.yaml", scene_text(r)));
    }
  }

  /// Written, with its meshes and heights in files, and read again.
  Scene through_file(Scene scene) {
    scene.film.width = 16, scene.film.height = 12;
    scene.integrator.samples = 1;
    const std::string path = dir_.file("drawn.yaml");
    write_scene_file(path, scene);
    Scene again = load_scene(path);
    again.film = scene.film, again.integrator = scene.integrator;
    for (const auto& entry : fs::directory_iterator(dir_.path()))
      if (entry.path().filename().string().starts_with("drawn")) fs::remove(entry.path());
    return again;
  }

  void render_scene(Scene scene, std::uint64_t i, CaseRandom& r) {
    const ImageTextures textures(scene.textures);
    RenderOptions options;
    options.textures = &textures;
    options.threads = 1 + static_cast<unsigned>(i % 3);
    options.data_layers = i % 2 == 0;
    options.build.quality = static_cast<BuildQuality>(i % 3);
    const std::atomic<bool> stop{i % 17 == 0};
    options.stop = &stop;
    CausticSettings& caustics = scene.integrator.caustics;
    caustics.photons = i % 4 == 0 ? 500 : 0;
    caustics.passes = 2;
    options.keep_photons = caustics.photons > 0;
    // Photons of another scene are an error while rendering.
    if (i % 29 == 0) options.photons = kept_photons_;
    if (i % 31 == 0) (void)read_photon_map(dir_.file("bad.photons"));
    RenderResult result = render(std::move(scene), options);
    ++pictures;
    if (result.photons != nullptr) {
      write_photon_map(dir_.file("a.photons"), *result.photons);
      kept_photons_ = read_photon_map(dir_.file("a.photons"));
    }
    if (i % 7 == 0 && options.data_layers && !result.report.stopped) denoise(result.picture);
    const char* const names[] = {"a.png", "a.exr", "b.png",     "b.exr",
                                 "a.hdr", "a.jpg", "a.unknown", "gone/a.png"};
    const std::string picture = dir_.file(names[r.bits() % std::size(names)]);
    write_image(picture, result.picture, {});
    (void)read_image(picture);
  }

  TempDir dir_;
  std::uint64_t seed_;
  bool shows_;
  std::vector<std::string> examples_;
  std::shared_ptr<const PhotonMap> kept_photons_;
};

int run(std::uint64_t renders, std::uint64_t seed, bool shows) {
  constexpr std::uint64_t kRows = 20;
  // Libraries, threads and the allocator's own memory come with the first renders.
  const std::uint64_t warm = std::max<std::uint64_t>(renders / 4, 1);
  Soak soak(seed, shows);
  std::size_t files = 0, most_before = 0, most_after = 0;
  const auto start = std::chrono::steady_clock::now();
  fmt::print("{:>8} {:>9} {:>7} {:>9} {:>13} {:>13} {:>6}\n", "renders", "pictures", "errors", "seconds",
             "resident MB", "allocated MB", "files");
  for (std::uint64_t i = 0; i < renders; ++i) {
    soak.run(i);
    if (i + 1 == warm) files = open_files();
    std::size_t& most = i < renders / 2 ? most_before : most_after;
    most = std::max(most, resident());
    if ((i + 1) % std::max<std::uint64_t>(renders / kRows, 1) != 0) continue;
    malloc_trim(0);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    fmt::print("{:8} {:9} {:7} {:9.1f} {:13.1f} {:13.1f} {:6}\n", i + 1, soak.pictures, soak.errors, seconds,
               static_cast<double>(resident()) / 1e6, static_cast<double>(allocated()) / 1e6, open_files());
    std::fflush(stdout);
  }
  int status = 0;
  if (open_files() != files) {
    fmt::print("{} files were open after {} renders, {} are now\n", files, warm, open_files());
    status = 1;
  }
  // A leak of one kilobyte a render would be ten megabytes in ten thousand.
  constexpr std::size_t kMargin = 16'000'000;
  if (kWatchesMemory && most_after > most_before + kMargin) {
    fmt::print("at most {:.1f} MB in the first half, {:.1f} MB in the second\n",
               static_cast<double>(most_before) / 1e6, static_cast<double>(most_after) / 1e6);
    status = 1;
  }
  return status;
}

}  // namespace
}  // namespace oktett::test

int main(int count, char** arguments) {
  std::uint64_t renders = 10000, seed = 1, shows = 0;
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string name = arguments[i];
    if (name == "--renders") renders = std::strtoull(arguments[i + 1], nullptr, 10);
    if (name == "--seed") seed = std::strtoull(arguments[i + 1], nullptr, 10);
    if (name == "--errors") shows = std::strtoull(arguments[i + 1], nullptr, 10);
  }
  if (count % 2 == 0 || renders == 0) {
    fmt::print(stderr, "render_soak [--renders N] [--seed N] [--errors 1]\n");
    return 2;
  }
  return oktett::test::run(renders, seed, shows != 0);
}
