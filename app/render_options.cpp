#include "app/render_options.h"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>

#include "app/command_line.h"
#include "app/limits.h"
#include "app/terminal/preview.h"
#include "app/text.h"
#include "core/error.h"
#include "io/image/image.h"
#include "io/mesh/load/load_mesh.h"

namespace oktett {

// ---- Options of `oktett render` for a folder that keeps meshes and trees.

void add_cache_options(Verb& verb, CacheArguments& a) {
  verb.option("--cache", &a.folder, "DIR", "Keep meshes and trees in DIR, for a fast start of the next run");
  verb.option("--cache-size", &a.size, "BYTES", "Most bytes in that folder; default: 16G");
}

std::unique_ptr<SceneCache> open_cache(const CacheArguments& arguments) {
  SceneCacheOptions options;
  if (!arguments.size.empty()) {
    if (arguments.folder.empty()) throw Error("--cache-size needs --cache");
    options.most_bytes = parse_bytes("--cache-size", arguments.size);
  }
  if (arguments.folder.empty()) return nullptr;
  options.tell = [](const std::string& problem) { say("warning: {}\n", problem); };
  try {
    return std::make_unique<SceneCache>(arguments.folder, options);
  } catch (const Error& error) {
    options.tell(error.what());
    return nullptr;
  }
}

namespace {

/// In the order of Look.
constexpr const char* kLooks[] = {"studio", "clay", "normals", "wire"};
/// In the order of Viewpoint.
constexpr const char* kViewpoints[] = {"auto", "outside", "inside"};
constexpr const char* kUps[] = {"x", "y", "z", "-x", "-y", "-z"};
/// In the order of BuildQuality.
constexpr const char* kQualities[] = {"fast", "balanced", "best", "compact"};

/// The index of `word` in a list of names. Throws Error if it is not in the list.
template <std::size_t N>
std::size_t index_of(const char* complaint, const std::string& word, const char* const (&names)[N],
                     const char* all) {
  for (std::size_t i = 0; i < N; ++i)
    if (word == names[i]) return i;
  const std::vector<std::string> known(names, names + N);
  throw Error(
      fmt::format("{} '{}'{}", complaint, word, did_you_mean(word, known, fmt::format("expected {}", all))));
}

}  // namespace

const char* to_string(IntegratorKind kind) {
  for (const Choice<IntegratorKind>& known : kIntegratorKinds)
    if (known.value == kind) return known.name;
  return "";
}

void add_pov_files_option(Verb& verb, std::string& folder) {
  verb.option("--files", &folder, "FOLDER",
              "Folder in which #fopen of a .pov may read and write; default: none");
}

void add_picture_options(Verb& verb, RenderArguments& a) {
  verb.option("-t,--nthreads", &a.threads, "N", "Threads; default: all processors");
  add_setting_options(verb, a.settings);
  verb.flag("--denoise", a.denoise, "Smooth the noise of the finished picture");
  verb.flag("--caustics", a.caustics, "Light through mirrors and glass by photons, with --integrator path");
  add_cache_options(verb, a.cache);
  verb.choice("--look", a.look, "LOOK", "How a mesh given alone is shown",
              {std::begin(kLooks), std::end(kLooks)});
  verb.choice("--up", a.up, "AXIS", "What points up in a mesh given alone, instead of a guess",
              {std::begin(kUps), std::end(kUps)});
  verb.choice("--view", a.viewpoint, "PLACE", "Where a mesh given alone is seen from",
              {std::begin(kViewpoints), std::end(kViewpoints)});
  verb.choice("--isa", a.isa, "NAME", "Instruction set", {"auto", "sse4.2", "avx2", "avx512", "scalar"});
  add_bvh_option(verb, a.bvh);
  verb.option("-D", &a.definitions, "k=v",
              "Define ${k} of the scene file, or declare k in a .pov; may be repeated");
  add_pov_files_option(verb, a.pov_files);
  add_gltf_options(verb, a.gltf, true);
  add_stroke_option(verb, a.gltf);
  add_limit_options(verb, a.limits);
}

void add_render_options(Verb& verb, RenderArguments& a) {
  verb.optional_positional("scene", a.scene, "SCENE|MESH", "Scene file (.yaml, .pov) or mesh");
  verb.option("-o,--outfile", &a.outfile, "FILE",
              "Picture to write; default: the scene's name with .png, here");
  add_frame_options(verb, a.frames);
  verb.flag("--no-output", a.no_output, "Write no picture, for measuring");
  add_bits_option(verb, a.bits);
  verb.option("--depth-unit", &a.depth_unit, "LENGTH",
              "Step of --integrator depth with --bits 16; default: a power of ten that fits");
  add_picture_options(verb, a);
  verb.option("--photon-map", &a.photon_map, "FILE",
              "Photons for --caustics: read from FILE, or written if it is missing");
  add_checkpoint_options(verb, a.checkpoints);
  verb.flag("--stats{text}", a.stats, "Print counts; --stats=json prints them as one JSON object");
  verb.flag("--quiet", a.quiet, "Print nothing but warnings and errors");
  verb.flag("-v,--verbose", a.verbose, "Print more, and all warnings");
  verb.flag("--progress", a.progress, "Show progress even if stderr is not a terminal");
  verb.option("--display-server", &a.display_server, "HOST:PORT",
              "Live preview in a viewer that speaks tev's protocol");
  add_show_option(verb, a.show);
}

void add_bits_option(Verb& verb, std::string& bits) {
  verb.choice("--bits", bits, "N", "Bits of each number in a PNG file; default: 8", {"8", "16"});
}

void check_bits(const std::string& bits, const std::string& picture) {
  if (bits.empty() || bits == "8") return;
  if (bits != "16") throw Error(fmt::format("--bits: '{}' is unknown; expected 8 or 16", bits));
  if (!picture.empty() && !can_store_words(picture))
    throw Error("--bits 16 is for PNG files; expected -o FILE.png");
}

bool shows_depth_units(const RenderArguments& arguments, const Scene& scene) {
  return arguments.bits == "16" && scene.integrator.kind == IntegratorKind::depth;
}

std::optional<double> depth_unit_of(const RenderArguments& arguments) {
  if (arguments.depth_unit.empty()) return std::nullopt;
  return parse_amount("--depth-unit", arguments.depth_unit, "units of the scene", 1e-30, 1e30);
}

void read_render_words(const std::vector<std::string>& words, RenderArguments& arguments) {
  CommandLine line(words);
  Verb verb = line.add_verb("render", "", [] { return 0; });
  add_render_options(verb, arguments);
  if (!line.read()) throw Error("the command line that began the picture is not one of this version");
}

void check_threads(unsigned threads) {
  if (threads > kMostThreads)
    throw Error(fmt::format("--nthreads: {} is out of range; expected 0 to {}", threads, kMostThreads));
}

void add_bvh_option(Verb& verb, std::string& quality) {
  verb.choice("--bvh", quality, "QUALITY", "How hard to build the tree",
              {std::begin(kQualities), std::end(kQualities)});
}

BuildOptions parse_bvh_option(const std::string& quality) {
  BuildOptions options;
  if (!quality.empty())
    options.quality = static_cast<BuildQuality>(
        index_of("--bvh: unknown quality", quality, kQualities, "fast, balanced, best or compact"));
  return options;
}

void override_scene(const RenderArguments& arguments, Scene& scene) {
  override_settings(arguments.settings, scene);
  CausticSettings& caustics = scene.integrator.caustics;
  if ((arguments.caustics || !arguments.photon_map.empty()) && caustics.photons == 0)
    caustics.photons = CausticSettings::kUsualPhotons;
}

std::optional<Look> look_of(const RenderArguments& arguments) {
  const bool alone = is_mesh_file(arguments.scene);
  if (arguments.look.empty()) {
    if (!alone || is_given(arguments.settings, "--integrator")) return std::nullopt;
    return Look::studio;
  }
  const auto look = static_cast<Look>(
      index_of("--look: unknown look", arguments.look, kLooks, "studio, clay, normals or wire"));
  if (!alone) throw Error("--look is for meshes given alone; a scene file says itself how it looks");
  if (is_given(arguments.settings, "--integrator"))
    throw Error("--look chooses the integrator; expected no --integrator");
  return look;
}

std::optional<Vec3d> up_of(const RenderArguments& arguments) {
  if (arguments.up.empty()) return std::nullopt;
  const std::size_t i = index_of("--up: unknown direction", arguments.up, kUps, "x, y, z, -x, -y or -z");
  if (!is_mesh_file(arguments.scene))
    throw Error("--up is for meshes given alone; the camera of a scene file says what is up");
  Vec3d up{0, 0, 0};
  up[static_cast<int>(i % 3)] = i < 3 ? 1 : -1;
  return up;
}

Viewpoint viewpoint_of(const RenderArguments& arguments) {
  if (arguments.viewpoint.empty()) return Viewpoint::automatic;
  const auto viewpoint = static_cast<Viewpoint>(
      index_of("--view: unknown place", arguments.viewpoint, kViewpoints, "auto, outside or inside"));
  if (!is_mesh_file(arguments.scene))
    throw Error("--view is for meshes given alone; the camera of a scene file says where it stands");
  if (is_given(arguments.settings, "--integrator"))
    throw Error("--view belongs to the looks of a mesh; expected no --integrator");
  return viewpoint;
}

Definitions parse_definitions(const std::vector<std::string>& words) {
  Definitions definitions;
  for (const std::string& word : words) {
    const std::size_t sign = word.find('=');
    if (sign == 0 || sign == std::string::npos)
      throw Error(fmt::format("-D: '{}' is not of the form name=value", word));
    definitions[word.substr(0, sign)] = word.substr(sign + 1);
  }
  return definitions;
}

std::string output_path(const RenderArguments& arguments) {
  if (arguments.no_output && !arguments.outfile.empty())
    throw Error("--no-output and --outfile exclude each other");
  if (arguments.no_output) return "";
  if (!arguments.outfile.empty()) return arguments.outfile;
  return std::filesystem::path(arguments.scene).stem().string() + ".png";
}

}  // namespace oktett
