#include "io/mesh/save/convert_mesh.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/gltf/gltf.h"
#include "io/gltf/write_glb.h"
#include "io/mesh/load/load_mesh.h"
#include "io/mesh/save/unread.h"
#include "io/mesh/weld.h"
#include "io/obj/write_obj.h"
#include "io/ply/write_ply.h"
#include "io/stl/write_stl.h"
#include "io/text/extension.h"

namespace oktett {
namespace {

namespace fs = std::filesystem;

struct WrittenFormat {
  std::string_view extension;
  bool has_text;       ///< there are files of text and of bytes
  bool has_materials;  ///< it can say them
  MeshLosses (*write)(const std::string& path, const MeshFile& file, bool ascii);
};

constexpr std::array kWrittenFormats{
    WrittenFormat{".obj", false, true,
                  [](const std::string& path, const MeshFile& file, bool) { return write_obj(path, file); }},
    WrittenFormat{".ply", true, false, write_ply},
    WrittenFormat{".stl", true, false, write_stl},
    WrittenFormat{".glb", false, true,
                  [](const std::string& path, const MeshFile& file, bool) { return write_glb(path, file); }},
};

const WrittenFormat& written_format(const std::string& path, const ConvertOptions& options) {
  const auto found =
      std::ranges::find(kWrittenFormats, lower_case_extension(path), &WrittenFormat::extension);
  if (found == kWrittenFormats.end())
    throw Error(Location{path}, "unknown kind of mesh file to write; expected .obj, .ply, .stl or .glb");
  if (options.ascii && !found->has_text)
    throw Error(Location{path}, "--ascii is for .ply and .stl, which are bytes without it");
  return *found;
}

/// What glTF says beside meshes.
void note_scene(const GltfScene& scene, MeshLosses& losses) {
  if (scene.placements.size() > scene.meshes.size())
    losses.push_back("changed: " + count_of(scene.placements.size() - scene.meshes.size(), "instance") +
                     " of meshes that are shown before, written as further triangles");
  if (scene.placements.size() > 1 ||
      std::ranges::any_of(scene.placements, [](const GltfPlacement& p) { return !p.name.empty(); }))
    losses.push_back("lost: names of " + count_of(scene.placements.size(), "object") +
                     ", which become one mesh");
  if (scene.camera) losses.push_back("lost: cameras");
  if (!scene.lights.empty()) losses.push_back("lost: " + count_of(scene.lights.size(), "light"));
}

MeshFile load(const std::string& path, const ConvertOptions& options, MeshLosses& losses) {
  if (!is_gltf_file(path)) {
    MeshFile file = load_mesh(path);
    note_unread(path, file.mesh.triangle_count(), losses);
    if (options.weld) weld_positions(file.mesh);
    return file;
  }
  GltfScene scene = load_gltf_scene(path);
  note_scene(scene, losses);
  MeshFile file = one_mesh(path, std::move(scene));
  if (options.weld) weld_positions(file.mesh);
  return file;
}

}  // namespace

void check_mesh_output(const std::string& path, const ConvertOptions& options) {
  written_format(path, options);
  const OutputFile probe(path);
}

Conversion convert_mesh(const std::string& input, const std::string& output, const ConvertOptions& options) {
  const WrittenFormat& format = written_format(output, options);
  std::error_code error;
  if (fs::equivalent(input, output, error)) throw Error(Location{output}, "is the input, too");
  Conversion result;
  MeshFile file = load(input, options, result.losses);
  result.triangles = file.mesh.triangle_count(), result.vertices = file.mesh.positions.size();
  result.warnings = std::move(file.warnings);
  if (result.triangles == 0) throw Error(Location{input}, "no triangles to convert");
  if (!format.has_materials) {
    if (!file.materials.empty())
      result.losses.push_back("lost: " + count_of(file.materials.size(), "material"));
    if (!file.textures.empty()) result.losses.push_back("lost: " + count_of(file.textures.size(), "texture"));
  }
  std::ranges::move(format.write(output, file, options.ascii), std::back_inserter(result.losses));
  return result;
}

}  // namespace oktett
