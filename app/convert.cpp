#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>

#include "app/command_line.h"
#include "app/gltf_words.h"
#include "app/limits.h"
#include "app/progress.h"
#include "app/render_options.h"
#include "app/text.h"
#include "core/error.h"
#include "io/mesh/load/load_mesh.h"
#include "io/mesh/save/convert_mesh.h"
#include "io/scene/pov_scene.h"
#include "io/text/files.h"

namespace oktett {
namespace {

struct ConvertArguments {
  std::string input, output;
  ConvertOptions options;
  GltfWords gltf;
  std::vector<std::string> definitions;
  std::string pov_files;
  LimitArguments limits;
  bool quiet = false;
};

/// Writes a scene in POV-Ray's language as a scene file.
int convert_scene(const ConvertArguments& arguments) {
  const std::string extension = lower_case_extension(arguments.output);
  if (extension != ".yaml" && extension != ".yml")
    throw Error(
        fmt::format("{}: a .pov becomes a scene file; expected the output .yaml or .yml", arguments.output));
  const PovConversion done =
      convert_pov(arguments.input, arguments.output, parse_definitions(arguments.definitions),
                  {kPovFilm, arguments.pov_files});
  print_warnings(done.warnings);
  if (arguments.quiet) return 0;
  for (const std::string& mesh : done.meshes) fmt::print("wrote {}\n", mesh);
  fmt::print("wrote {}\n", arguments.output);
  std::fflush(stdout);
  return 0;
}

int run_convert(const ConvertArguments& arguments) {
  apply_limits(arguments.limits);
  if (is_pov_file(arguments.input)) return convert_scene(arguments);
  // A file that cannot be written is refused before a long one is read.
  check_mesh_output(arguments.output, arguments.options);
  const Conversion done = [&] {
    const PhaseLine phases(arguments.quiet);
    ConvertOptions options = arguments.options;
    options.gltf = gltf_options(arguments.gltf);
    return convert_mesh(arguments.input, arguments.output, options);
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
  Verb verb = line.add_verb("convert", "Write a mesh in another format, or a .pov as a scene file",
                            [a] { return run_convert(*a); });
  verb.positional("input", a->input, "INPUT",
                  ("Mesh to read: " + mesh_extensions() + "; or a scene: .pov").c_str());
  verb.positional("output", a->output, "OUTPUT",
                  ("File to write: " + or_list(written_mesh_extensions()) + "; of a .pov: .yaml").c_str());
  verb.flag("--ascii", a->options.ascii,
            ("Write text instead of bytes (" + and_list(text_mesh_extensions()) + ")").c_str());
  verb.flag("--weld", a->options.weld, "Make one of all vertices at the same place");
  add_gltf_options(verb, a->gltf, false);
  verb.option("-D", &a->definitions, "k=v", "Declare k in the .pov; may be repeated");
  add_pov_files_option(verb, a->pov_files);
  verb.flag("--quiet", a->quiet, "Print nothing but warnings and errors");
  add_limit_options(verb, a->limits);
}

}  // namespace oktett
