#include "io/mesh/load/load_mesh.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "io/gltf/gltf.h"
#include "io/mesh/load/parse_mesh.h"
#include "io/mesh/weld.h"
#include "io/obj/parsed_obj.h"
#include "io/ply/ply.h"
#include "io/stl/stl.h"
#include "io/text/extension.h"

namespace oktett {
namespace {

struct Format {
  std::string_view extension;
  ParsedMesh (*parse)(const std::string& path);  ///< null: the file is read in one step
  MeshFile (*load)(const std::string& path);
};

MeshFile load_plain(const std::string& path) { return finish_mesh(path, parse_mesh(path)); }

MeshFile load_gltf(const std::string& path) { return one_mesh(path, load_gltf_scene(path)); }

constexpr std::array kFormats{
    Format{".obj", parse_obj, load_obj},
    Format{".ply", [](const std::string& path) { return parse_ply(path); }, load_plain},
    Format{".stl", [](const std::string& path) { return parse_stl(path); }, load_plain},
    Format{".gltf", nullptr, load_gltf},
    Format{".glb", nullptr, load_gltf},
};

/// The format of a file of that name, or null.
const Format* find_format(const std::string& path) {
  const std::string extension = lower_case_extension(without_packing(path));
  const auto found = std::ranges::find(kFormats, extension, &Format::extension);
  return found == kFormats.end() ? nullptr : found;
}

const Format& format_of(const std::string& path) {
  if (const Format* const format = find_format(path)) return *format;
  throw Error(Location{path}, std::string("unknown kind of mesh file; expected ") + mesh_extensions());
}

}  // namespace

bool repeats_vertices(const std::string& path) {
  return lower_case_extension(without_packing(path)) == ".stl";
}

std::vector<Error> find_mesh_errors(const std::string& path) {
  const Format* const format = find_format(path);
  return format != nullptr && format->parse == parse_obj ? find_obj_errors(path) : std::vector<Error>{};
}

bool is_mesh_file(const std::string& path) { return find_format(path) != nullptr; }

const char* mesh_extensions() { return ".obj, .ply, .stl, .gltf or .glb, also packed as .gz"; }

bool can_parse_mesh(const std::string& path) { return format_of(path).parse != nullptr; }

ParsedMesh parse_mesh(const std::string& path) { return format_of(path).parse(path); }

MeshFile finish_mesh(const std::string& path, ParsedMesh parsed) {
  return finish_obj(path, std::move(parsed));
}

MeshFile load_mesh(const std::string& path, const MeshOptions& options) {
  MeshFile file = format_of(path).load(path);
  if (options.weld) weld_positions(file.mesh);
  return file;
}

}  // namespace oktett
