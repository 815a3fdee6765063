#include "io/scene/check.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "io/image/texture.h"
#include "io/mesh/load/load_mesh.h"
#include "io/obj/obj.h"
#include "io/scene/meshes.h"
#include "io/scene/readers.h"
#include "io/text/files.h"
#include "io/yaml/utf8.h"

namespace oktett {
namespace {

class Checking {
 public:
  Checking(const std::string& path, const Definitions& definitions, const PovOptions& pov)
      : path_(path), definitions_(definitions), pov_(pov) {}

  Findings run() {
    const std::string extension = lower_case_extension(path_);
    if (const std::string reason = why_unreadable(path_); !reason.empty())
      add(Error(Location{path_}, reason, ErrorKind::io));
    else if (extension == ".yaml" || extension == ".yml" || extension == ".pov")
      check_scene();
    else if (extension == ".mtl")
      attempt([&] { check_materials(); });
    else
      check_mesh();
    sort();
    return std::move(found_);
  }

 private:
  void add(const Error& error) {
    found_.list.push_back(
        {error.where(), error.what(),
         error.kind() == ErrorKind::io ? SceneFinding::Kind::io : SceneFinding::Kind::bad_input});
  }
  void add(const std::vector<Warning>& warnings) {
    for (const Warning& warning : warnings)
      found_.list.push_back({warning.where, to_string(warning), SceneFinding::Kind::warning});
  }

  template <class Read>
  void attempt(const Read& read) {
    try {
      read();
    } catch (const Error& error) {
      add(error);
    }
  }

  void check_scene() {
    SceneLoad load(definitions_);
    ErrorList errors;
    load.errors = &errors;
    load.pov = pov_;
    const FilesRead files;
    try {
      read_scene_file(path_, load);
    } catch (const TooManyErrors&) {
      found_.has_more = true;
    }
    for (const Error& error : errors.errors()) add(error);
    add(load.scene.warnings);
    warn_of_unused_statements(files);
    if (errors.failures() == 0) warn_of_unused(load);
    add(ImageTextures(load.scene.textures, load.scene.texture_places).warnings());
  }

  /// Of names in the file itself: files that others include define names for some of them.
  void warn_of_unused(const SceneLoad& load) {
    const auto warn = [&](const NameTable& names, const char* what) {
      for (const auto& [name, entry] : names.entries)
        if (!entry.used && entry.where.file == path_)
          add({Warning{entry.where, std::string(what) + " " + quote(name) + " is not used"}});
    };
    warn(load.materials, "material");
    warn(load.media, "medium");
    warn(load.prototypes, "prototype");
  }

  void check_materials() {
    MeshFile file;
    MtlPlaces places;
    load_mtl(path_, file.materials, file.textures, file.warnings, &places);
    file.texture_places = std::move(places.textures);
    check_textures(file);
    add(file.warnings);
    add(places.unused);
  }

  /// Of the MTL files that meshes name.
  void warn_of_unused_statements(const FilesRead& files) {
    for (const std::string& path : files.paths()) {
      if (lower_case_extension(path) != ".mtl") continue;
      MeshFile file;
      MtlPlaces places;
      // What else is wrong in it has been reported.
      try {
        load_mtl(path, file.materials, file.textures, file.warnings, &places);
      } catch (const Error&) {
        continue;
      }
      add(places.unused);
    }
  }

  void check_mesh() {
    try {
      const FilesRead files;
      const Scene scene = load_scene(path_, definitions_);
      add(scene.warnings);
      warn_of_unused_statements(files);
      add(ImageTextures(scene.textures, scene.texture_places).warnings());
    } catch (const Error& error) {
      attempt([&] {
        for (const Error& each : find_mesh_errors(path_)) add(each);
      });
      if (found_.list.empty()) add(error);
    }
  }

  void sort() {
    std::vector<std::string> files{path_};
    const auto number = [&](const SceneFinding& finding) {
      const auto file = std::ranges::find(files, finding.where.file);
      const auto index = file - files.begin();
      if (file == files.end()) files.push_back(finding.where.file);
      return index;
    };
    std::vector<std::pair<std::tuple<std::ptrdiff_t, int, int>, SceneFinding>> keyed;
    for (SceneFinding& finding : found_.list) {
      const std::tuple key(number(finding), finding.where.line, finding.where.column);
      keyed.emplace_back(key, std::move(finding));
    }
    std::ranges::stable_sort(keyed, {},
                             &std::pair<std::tuple<std::ptrdiff_t, int, int>, SceneFinding>::first);
    found_.list.clear();
    for (auto& [key, finding] : keyed) found_.list.push_back(std::move(finding));
  }

  const std::string path_;
  const Definitions definitions_;
  const PovOptions pov_;
  Findings found_;
};

}  // namespace

Findings check_file(const std::string& path, const Definitions& definitions, const PovOptions& pov) {
  return Checking(path, definitions, pov).run();
}

}  // namespace oktett
