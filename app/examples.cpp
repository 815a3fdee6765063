#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "app/command_line.h"
#include "core/description.h"
#include "core/error.h"
#include "io/scene/scene_file.h"
#include "io/text/files.h"

namespace oktett {
namespace {

namespace fs = std::filesystem;

struct ExampleArguments {
  std::vector<std::string> names;
  std::string folder;
  bool force = false;
};

/// The folder of the example scenes: share/oktett/scenes beside the folder of this program, which installing
/// and building put there.
fs::path scenes_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path folder = fs::canonical(program.parent_path() / "../share/oktett/scenes", error);
  if (error || !fs::is_directory(folder))
    throw Error("the example scenes are not installed; expected them in " +
                    (program.parent_path().parent_path() / "share/oktett/scenes").string(),
                ErrorKind::io);
  return folder;
}

/// The names of all examples, without extension, in alphabetical order.
std::vector<std::string> example_names(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  std::ranges::sort(names);
  return names;
}

/// The first sentence of the comments at the head of a scene file.
std::string summary_of(const fs::path& path) {
  std::ifstream file(path);
  std::string text;
  for (std::string line; std::getline(file, line) && line.starts_with('#');) {
    if (line.find("yaml-language-server") != std::string::npos) continue;
    const std::size_t start = line.find_first_not_of("# ");
    if (start == std::string::npos) break;
    text += (text.empty() ? "" : " ") + line.substr(start);
  }
  // Its first sentence.
  for (std::size_t i = 1; i + 2 < text.size(); ++i)
    if (text.compare(i, 2, ". ") == 0 && text[i + 2] >= 'A' && text[i + 2] <= 'Z')
      return text.substr(0, i + 1);
  return text;
}

/// The scene file `name` and all files in `folder` that it reads, relative to `folder`.
std::vector<fs::path> files_of(const fs::path& folder, const std::string& name) {
  const fs::path scene = folder / (name + ".yaml");
  std::vector<fs::path> files = {scene.filename()};
  const FilesRead read;
  const Scene loaded = load_scene(scene.string());
  std::vector<std::string> paths = read.paths();
  for (const Texture& texture : loaded.textures) paths.push_back(texture.path);
  for (const std::string& path : paths) {
    std::error_code error;
    const fs::path relative = fs::canonical(path, error).lexically_relative(folder);
    const bool ours = !error && !relative.empty() && *relative.begin() != "..";
    if (ours && std::ranges::find(files, relative) == files.end()) files.push_back(relative);
  }
  return files;
}

void copy(const fs::path& from, const fs::path& to, bool force) {
  try {
    fs::create_directories(to.parent_path());
    if (fs::exists(to) && !force)
      throw Error(Location{to.string()}, "the file exists; --force replaces it", ErrorKind::io);
    fs::copy_file(from, to, fs::copy_options::overwrite_existing);
    // Installed files may be read-only, but copies are there to be edited.
    fs::permissions(to, fs::perms::owner_write, fs::perm_options::add);
  } catch (const fs::filesystem_error& error) {
    throw Error(Location{to.string()}, "cannot write: " + error.code().message(), ErrorKind::io);
  }
}

int run_examples(const ExampleArguments& arguments) {
  const fs::path folder = scenes_folder();
  const std::vector<std::string> names = example_names(folder);
  if (arguments.names.empty()) {
    for (const std::string& name : names)
      fmt::print("{:<14} {}\n", name, summary_of(folder / (name + ".yaml")));
    fmt::print("\noktett examples NAME... copies scenes here, with the files that they need.\n");
    return 0;
  }
  for (const std::string& name : arguments.names)
    if (std::ranges::find(names, name) == names.end())
      throw Error(fmt::format("there is no example '{}'{}", name,
                              did_you_mean(name, names, "'oktett examples' lists them")));
  const fs::path target = arguments.folder.empty() ? fs::path(".") : fs::path(arguments.folder);
  std::vector<fs::path> files;
  for (const std::string& name : arguments.names)
    for (const fs::path& file : files_of(folder, name))
      if (std::ranges::find(files, file) == files.end()) files.push_back(file);
  for (const fs::path& file : files) {
    copy(folder / file, target / file, arguments.force);
    fmt::print("{}\n", (target / file).lexically_normal().string());
  }
  return 0;
}

}  // namespace

void add_examples_command(CommandLine& line) {
  const auto arguments = std::make_shared<ExampleArguments>();
  Verb verb = line.add_verb("examples", "List or copy the example scenes",
                            [arguments] { return run_examples(*arguments); });
  verb.optional_positionals("names", arguments->names, "NAME...",
                            "Examples to copy; without names all are listed");
  verb.option("-o,--outdir", &arguments->folder, "DIR", "Where to copy them; default: here");
  verb.flag("--force", arguments->force, "Replace files that exist");
}

}  // namespace oktett
