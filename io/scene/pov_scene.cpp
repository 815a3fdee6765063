#include "io/scene/pov_scene.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <utility>

#include "io/mesh/mesh_file.h"
#include "io/ply/ply.h"
#include "io/pov/read_pov.h"
#include "io/pov/translate/translate.h"
#include "io/scene/pov_queries.h"
#include "io/scene/shape_text.h"
#include "io/text/files.h"
#include "io/yaml/write_yaml.h"

namespace oktett {

bool is_pov_file(const std::string& path) { return lower_case_extension(path) == ".pov"; }

pov::TranslatedScene read_pov_tree(const std::string& path, const Definitions& definitions,
                                   const PovOptions& pov, const std::string& mesh_prefix) {
  const Film& film = pov.film;
  PovQueries queries;
  pov::ReadOptions options;
  options.queries = &queries;
  options.file_folder = pov.files, options.said = pov.said;
  options.image_width = static_cast<int>(film.width), options.image_height = static_cast<int>(film.height);
  for (const auto& [name, text] : definitions) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc{} && end == text.data() + text.size())
      options.definitions[name] = value;
    else
      options.definitions[name] = text;
  }
  const pov::Document document = pov::read_pov(path, options);
  queries.begin(document);
  pov::TranslatedScene scene = pov::translate(document, {film.width, film.height, mesh_prefix, &queries});
  for (Warning& warning : queries.take_warnings()) {
    const auto is_same = [&](const Warning& other) { return to_string(other) == to_string(warning); };
    if (std::ranges::none_of(scene.warnings, is_same)) scene.warnings.push_back(std::move(warning));
  }
  return scene;
}

PovConversion convert_pov(const std::string& input, const std::string& output, const Definitions& definitions,
                          const PovOptions& options) {
  namespace fs = std::filesystem;
  const fs::path path(output);
  const pov::TranslatedScene scene = read_pov_tree(input, definitions, options, path.stem().string() + "-");
  PovConversion done;
  for (const auto& [name, mesh] : scene.meshes) {
    MeshFile file;
    file.mesh = *mesh;
    done.meshes.push_back((path.parent_path() / name).string());
    write_ply(done.meshes.back(), file, false);
  }
  write_text(output, yaml_text(*scene.root));
  done.warnings = scene.warnings;
  return done;
}

}  // namespace oktett
