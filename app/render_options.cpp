#include "app/render_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string_view>
#include <system_error>

#include "core/error.h"

namespace oktett {

namespace {

constexpr const char* kIntegrators[] = {"whitted", "path", "ao", "normal", "depth"};
/// In the order of BuildQuality.
constexpr const char* kQualities[] = {"fast", "balanced", "best"};
// The same bounds as in a scene file.
constexpr std::uint32_t kMaxSide = 65536;
constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 30;
constexpr std::uint32_t kMaxSamples = 65536;

/// Reads a number. All of `text` must belong to it.
template <class T>
bool parse_number(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

void parse_size(const std::string& text, Film& film) {
  const std::size_t cross = text.find('x');
  const bool good = cross != std::string::npos && parse_number(text.substr(0, cross), film.width) &&
                    parse_number(text.substr(cross + 1), film.height);
  if (!good) throw Error(fmt::format("--size: '{}' is not of the form WxH, e.g. 960x540", text));
  const bool fits = film.width >= 1 && film.width <= kMaxSide && film.height >= 1 &&
                    film.height <= kMaxSide && std::uint64_t{film.width} * film.height <= kMaxPixels;
  if (!fits)
    throw Error(fmt::format("--size: {} is out of range; expected sides of 1 to {} and at most {} pixels",
                            text, kMaxSide, kMaxPixels));
}

void parse_crop(const std::string& text, double (&crop)[4]) {
  std::string_view rest = text;
  bool good = true;
  for (int i = 0; i < 4; ++i) {
    const std::size_t comma = rest.find(',');
    good = good && parse_number(rest.substr(0, comma), crop[i]) && crop[i] >= 0 && crop[i] <= 1;
    good = good && (comma == std::string_view::npos) == (i == 3);
    rest = comma == std::string_view::npos ? std::string_view{} : rest.substr(comma + 1);
  }
  if (!good || crop[0] >= crop[1] || crop[2] >= crop[3])
    throw Error(fmt::format(
        "--cropwindow: '{}' is not of the form x0,x1,y0,y1 with 0 <= x0 < x1 <= 1 and 0 <= y0 < y1 <= 1",
        text));
}

/// The index of `word` in a list of names. Throws Error if it is not in the list.
template <std::size_t N>
std::size_t index_of(const char* complaint, const std::string& word, const char* const (&names)[N],
                     const char* all) {
  for (std::size_t i = 0; i < N; ++i)
    if (word == names[i]) return i;
  const std::string near = nearest_name(word, names, N);
  throw Error(
      fmt::format("{} '{}'; {}", complaint, word,
                  near.empty() ? fmt::format("expected {}", all) : fmt::format("did you mean '{}'?", near)));
}

}  // namespace

const char* to_string(IntegratorKind kind) { return kIntegrators[static_cast<std::size_t>(kind)]; }

void add_render_options(CLI::App& verb, RenderArguments& a) {
  verb.add_option("scene", a.scene, "Scene file (.yaml) or mesh (.obj)")->required()->type_name("SCENE|MESH");
  verb.add_option("-o,--outfile", a.outfile, "Picture to write; default: the scene's name with .png, here")
      ->type_name("FILE");
  verb.add_option("-t,--nthreads", a.threads, "Threads; default: all processors")->type_name("N");
  verb.add_option("--spp", a.samples, "Samples per pixel")->type_name("N");
  verb.add_option("--size", a.size, "Size of the full frame in pixels")->type_name("WxH");
  verb.add_option("--cropwindow", a.crop, "Part of the frame to render, as fractions of it")
      ->type_name("x0,x1,y0,y1");
  verb.add_option("--seed", a.seed, "Seed of the random numbers")->type_name("N");
  verb.add_option("--integrator", a.integrator, "whitted, path, ao, normal or depth")->type_name("K");
  verb.add_option("--isa", a.isa, "Instruction set: auto, sse4.2, avx2, avx512 or scalar")->type_name("NAME");
  add_bvh_option(verb, a.bvh);
  verb.add_option("-D", a.definitions, "Define ${k} of the scene file; may be repeated")
      ->type_name("k=v")
      ->allow_extra_args(false);
  verb.add_flag("--stats{text}", a.stats, "Print counts; --stats=json prints them as one JSON object");
  verb.add_flag("--quiet", a.quiet, "Print nothing but warnings and errors");
  verb.add_flag("-v,--verbose", a.verbose, "Print more, and all warnings");
  verb.add_flag("--progress", a.progress, "Show progress even if stderr is not a terminal");
  verb.add_option("--display-server", a.display_server, "Live preview in a viewer that speaks tev's protocol")
      ->type_name("HOST:PORT");
}

void add_bvh_option(CLI::App& verb, std::string& quality) {
  verb.add_option("--bvh", quality, "How hard to build the tree: fast, balanced or best")
      ->type_name("QUALITY");
}

BuildOptions parse_bvh_option(const std::string& quality) {
  BuildOptions options;
  if (!quality.empty())
    options.quality = static_cast<BuildQuality>(
        index_of("--bvh: unknown quality", quality, kQualities, "fast, balanced or best"));
  return options;
}

void override_scene(const RenderArguments& arguments, Scene& scene) {
  if (!arguments.size.empty()) parse_size(arguments.size, scene.film);
  if (!arguments.crop.empty()) parse_crop(arguments.crop, scene.film.crop);
  if (!arguments.integrator.empty())
    scene.integrator.kind =
        static_cast<IntegratorKind>(index_of("--integrator: unknown kind", arguments.integrator, kIntegrators,
                                             "whitted, path, ao, normal or depth"));
  if (arguments.seed) scene.integrator.seed = *arguments.seed;
  if (arguments.samples) {
    if (*arguments.samples < 1 || *arguments.samples > kMaxSamples)
      throw Error(
          fmt::format("--spp: {} is out of range; expected 1 to {}", *arguments.samples, kMaxSamples));
    scene.integrator.samples = *arguments.samples;
  }
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
  if (!arguments.outfile.empty()) return arguments.outfile;
  return std::filesystem::path(arguments.scene).stem().string() + ".png";
}

}  // namespace oktett
