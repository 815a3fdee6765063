#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "app/command_line.h"
#include "app/gltf_words.h"
#include "app/limits.h"
#include "app/progress.h"
#include "app/render_options.h"
#include "app/text.h"
#include "core/error.h"
#include "io/mesh/load/load_mesh.h"
#include "io/mesh/save/convert_mesh.h"
#include "io/mesh/vertices.h"
#include "io/scene/pov_scene.h"
#include "io/scene/scene_file.h"
#include "io/scene/scene_mesh.h"
#include "io/text/files.h"

namespace oktett {
namespace {

struct ConvertArguments {
  std::string input, output;
  ConvertOptions options;
  GltfWords gltf;
  std::vector<std::string> definitions;
  std::string pov_files;
  std::string resolution, tolerance, select;  ///< of meshes of scenes
  LimitArguments limits;
  bool quiet = false;
};

/// Writes a scene in POV-Ray's language as a scene file.
int convert_scene(const ConvertArguments& arguments) {
  const PovConversion done =
      convert_pov(arguments.input, arguments.output, parse_definitions(arguments.definitions),
                  {kPovFilm, arguments.pov_files, arguments.quiet ? nullptr : &say_as_is});
  print_warnings(done.warnings);
  if (arguments.quiet) return 0;
  for (const std::string& mesh : done.meshes) fmt::print("wrote {}\n", mesh);
  fmt::print("wrote {}\n", arguments.output);
  std::fflush(stdout);
  return 0;
}

/// Throws Error unless the words are numbers in their ranges.
SceneMeshOptions scene_mesh_options(const ConvertArguments& arguments) {
  SceneMeshOptions options;
  if (!arguments.resolution.empty()) {
    if (!arguments.tolerance.empty())
      throw Error("--resolution and --tolerance exclude each other: each says how fine grids are");
    options.resolution = static_cast<std::uint32_t>(
        parse_amount("--resolution", arguments.resolution, "cells", 1, kMostMeshCells));
  }
  if (!arguments.tolerance.empty())
    options.tolerance = parse_amount("--tolerance", arguments.tolerance, "units of the scene", 1e-30, 1e30);
  options.select = arguments.select;
  return options;
}

/// Refuses what only meshes of scenes have.
void check_no_scene_options(const ConvertArguments& arguments) {
  const std::pair<const char*, const std::string&> words[] = {{"--resolution", arguments.resolution},
                                                              {"--tolerance", arguments.tolerance},
                                                              {"--select", arguments.select}};
  for (const auto& [option, word] : words)
    if (!word.empty()) throw Error(fmt::format("{}: {} is for a mesh of a scene", arguments.input, option));
}

bool is_scene_file(const std::string& path) {
  const std::string extension = lower_case_extension(path);
  return extension == ".yaml" || extension == ".yml";
}

/// Makes one mesh of a scene.
Conversion mesh_scene(const ConvertArguments& arguments, const ConvertOptions& options) {
  const Scene scene =
      load_scene(arguments.input, parse_definitions(arguments.definitions), std::nullopt, options.gltf,
                 {kPovFilm, arguments.pov_files, arguments.quiet ? nullptr : &say_as_is});
  MeshFile file = mesh_of_scene(scene, scene_mesh_options(arguments));
  if (options.weld) weld_positions(file.mesh);
  return write_mesh(arguments.input, std::move(file), arguments.output, options);
}

int run_convert(const ConvertArguments& arguments) {
  apply_limits(arguments.limits);
  const bool is_pov = is_pov_file(arguments.input), is_scene = is_pov || is_scene_file(arguments.input);
  if (is_pov && is_scene_file(arguments.output)) {
    check_no_scene_options(arguments);
    return convert_scene(arguments);
  }
  // A file that cannot be written is refused before a long one is read.
  check_mesh_output(arguments.output, arguments.options);
  if (is_scene)
    scene_mesh_options(arguments);
  else
    check_no_scene_options(arguments);
  const Conversion done = [&] {
    const PhaseLine phases(arguments.quiet);
    ConvertOptions options = arguments.options;
    options.gltf = gltf_options(arguments.gltf);
    return is_scene ? mesh_scene(arguments, options)
                    : convert_mesh(arguments.input, arguments.output, options);
  }();
  print_warnings(done.warnings);
  if (arguments.quiet) return 0;
  for (const std::string& loss : done.losses) say("{}: {}\n", arguments.output, loss);
  fmt::print("wrote {}: {} triangles, {} vertices\n", arguments.output, grouped(done.triangles),
             grouped(done.vertices));
  std::fflush(stdout);
  return 0;
}

}  // namespace

void add_convert_command(CommandLine& line) {
  const auto a = std::make_shared<ConvertArguments>();
  Verb verb = line.add_verb("convert",
                            "Write a mesh in another format, a scene as one mesh, or a .pov as a scene file",
                            [a] { return run_convert(*a); });
  verb.positional("input", a->input, "INPUT",
                  ("Mesh to read: " + mesh_extensions() + "; or a scene: .yaml or .pov").c_str());
  verb.positional(
      "output", a->output, "OUTPUT",
      ("File to write: " + or_list(written_mesh_extensions()) + "; of a .pov also .yaml").c_str());
  verb.option("--resolution", &a->resolution, "N",
              "Scenes: cells along the longest edge of each exact shape; default: 64");
  verb.option("--tolerance", &a->tolerance, "LENGTH", "Scenes: refine until triangles are no farther off");
  verb.option("--select", &a->select, "NAME", "Scenes: only the objects of this name");
  verb.flag("--ascii", a->options.ascii,
            ("Write text instead of bytes (" + and_list(text_mesh_extensions()) + ")").c_str());
  verb.flag("--weld", a->options.weld, "Make one of all vertices at the same place");
  add_gltf_options(verb, a->gltf, false);
  verb.option("-D", &a->definitions, "k=v",
              "Set ${k} in a scene file, or declare k in a .pov; may be repeated");
  add_pov_files_option(verb, a->pov_files);
  verb.flag("--quiet", a->quiet, "Print nothing but warnings and errors");
  add_limit_options(verb, a->limits);
}

}  // namespace oktett
