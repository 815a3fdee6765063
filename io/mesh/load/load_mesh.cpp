#include "io/mesh/load/load_mesh.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "io/gltf/gltf.h"
#include "io/mesh/load/load_file_scene.h"
#include "io/mesh/load/parse_mesh.h"
#include "io/mesh/vertices.h"
#include "io/off/off.h"
#include "io/ply/ply.h"
#include "io/stl/stl.h"
#include "io/text/files.h"
#include "io/threemf/threemf.h"

namespace oktett {
namespace {

/// All that reading knows of a format.
struct ReadFormat {
  std::string_view extension;
  ParsedMesh (*parse)(const std::string& path) = nullptr;  ///< null: the file is read in one step
  MeshFile (*load)(const std::string& path) = nullptr;     ///< null: as one mesh of load_scene
  std::vector<Error> (*find_errors)(const std::string& path) = nullptr;  ///< null: the first one is all
  bool repeats_vertices = false;                                         ///< see load_mesh.h
  /// Of formats that place meshes.
  FileScene (*load_scene)(const std::string& path, const GltfOptions& options) = nullptr;
};

template <ParsedMesh (*parse)(const std::string&, const MeshReadOptions&)>
ParsedMesh parse_by_default(const std::string& path) {
  return parse(path, {});
}

MeshFile load_in_two_steps(const std::string& path) { return finish_mesh(path, parse_mesh(path)); }

FileScene load_threemf(const std::string& path, const GltfOptions&) { return load_threemf_scene(path); }

constexpr std::array kReadFormats{
    ReadFormat{".obj", parse_obj, load_obj, find_obj_errors},
    ReadFormat{".ply", parse_by_default<parse_ply>, load_in_two_steps},
    ReadFormat{".stl", parse_by_default<parse_stl>, load_in_two_steps, nullptr, true},
    ReadFormat{".off", parse_by_default<parse_off>, load_in_two_steps},
    ReadFormat{.extension = ".3mf", .load_scene = load_threemf},
    ReadFormat{.extension = ".gltf", .load_scene = load_gltf_scene},
    ReadFormat{.extension = ".glb", .load_scene = load_gltf_scene},
};

/// The format of a file of that name, or null.
const ReadFormat* find_format(const std::string& path) {
  const std::string extension = lower_case_extension(without_packing(path));
  const auto found = std::ranges::find(kReadFormats, extension, &ReadFormat::extension);
  return found == kReadFormats.end() ? nullptr : found;
}

const ReadFormat& format_of(const std::string& path) {
  if (const ReadFormat* const format = find_format(path)) return *format;
  throw Error(Location{path}, "unknown kind of mesh file; expected " + mesh_extensions());
}

}  // namespace

bool repeats_vertices(const std::string& path) {
  const ReadFormat* const format = find_format(path);
  return format != nullptr && format->repeats_vertices;
}

std::vector<Error> find_mesh_errors(const std::string& path) {
  const ReadFormat* const format = find_format(path);
  if (format == nullptr || format->find_errors == nullptr) return {};
  return format->find_errors(path);
}

bool is_mesh_file(const std::string& path) { return find_format(path) != nullptr; }

std::string mesh_extensions() {
  std::vector<std::string> extensions;
  for (const ReadFormat& format : kReadFormats) extensions.emplace_back(format.extension);
  return or_list(extensions) + ", also packed as .gz";
}

bool can_parse_mesh(const std::string& path) { return format_of(path).parse != nullptr; }

ParsedMesh parse_mesh(const std::string& path) { return format_of(path).parse(path); }

bool has_file_scene(const std::string& path) {
  const ReadFormat* const format = find_format(path);
  return format != nullptr && format->load_scene != nullptr;
}

void check_gltf_options(const std::string& path, const GltfOptions& options) {
  if (!is_gltf_file(path) && options.is_for_gltf())
    throw Error(Location{path}, "a time and variants are for glTF files");
}

FileScene load_file_scene(const std::string& path, const GltfOptions& options) {
  check_gltf_options(path, options);
  return format_of(path).load_scene(path, options);
}

MeshFile load_mesh(const std::string& path, const MeshOptions& options) {
  const ReadFormat& format = format_of(path);
  MeshFile file =
      format.load_scene != nullptr ? one_mesh(path, format.load_scene(path, {})) : format.load(path);
  if (options.weld) weld_positions(file.mesh);
  return file;
}

}  // namespace oktett
