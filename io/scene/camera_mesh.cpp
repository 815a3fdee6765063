/// \file The meshes of a camera.

#include <memory>
#include <utility>
#include <vector>

#include "io/mesh/load/load_mesh.h"
#include "io/scene/readers.h"
#include "io/scene/schema.h"
#include "render/camera_mesh.h"

namespace oktett {
namespace {

/// Most meshes of a camera.
constexpr std::uint32_t kMostMeshes = 1024;
constexpr const char* kWhat = "the mesh of a camera";

/// One of the meshes.
struct CameraMeshFile {
  Affine transform;

  static constexpr const char* kMap = "a mesh of a camera";
  void describe(auto& p) {
    p.required("file", ByHand{"mesh file", "file"}, "triangles, in the order in which they count");
    p.optional("transform", transform, "where it is");
  }
};

/// All meshes, which describe() cannot read by itself.
struct CameraMeshFiles {
  std::vector<SeeingMesh> meshes;
};

/// What all of it says.
struct CameraMeshText {
  CameraMeshFiles files;
  CameraMesh::Settings settings;

  void describe(auto& p) {
    p.required("meshes", files, "list of `{file, transform}`");
    settings.describe(p);
  }
};

const MeshLibrary::Entry& entry_of(SceneLoad& load, const YamlNode& file) {
  if (const MeshLibrary::Entry* const given = load.meshes.find(load.values.text(file))) return *given;
  const std::string path = load.values.existing_file(file);
  if (!is_mesh_file(path))
    throw Error(file.where(), std::string("unknown kind of mesh file; expected ") + mesh_extensions());
  return load.meshes.load(path, {}, load.scene);
}

void read_value(SceneLoad& load, const YamlNode& node, const Range&, CameraMeshFiles& files) {
  const auto items = list_items(node, "meshes");
  if (items.empty() || items.size() > kMostMeshes)
    throw Error(node.where(),
                fmt::format("a camera has {} meshes; expected 1 to {}", items.size(), kMostMeshes));
  for (const YamlNode* item : items)
    attempt(*item, [&] {
      CameraMeshFile one;
      const Fields fields = read_described(load, *item, CameraMeshFile::kMap, one);
      const YamlNode& file = fields.require("file");
      if (file.missing) return;
      const MeshLibrary::Entry& entry = entry_of(load, file);
      if (entry.mesh->triangle_count() == 0)
        throw Error(file.where(), "a camera sees from triangles, but the mesh has none");
      if (const std::string reason = why_degenerate(one.transform); !reason.empty())
        throw Error(fields.require("transform").where(), reason);
      files.meshes.push_back({entry.mesh, one.transform});
    });
}

std::string schema_of(Schema& schema, const Range&, const CameraMeshFiles&) {
  return Schema::list(schema.map(CameraMeshFile::kMap, CameraMeshFile{}), whole(1, kMostMeshes));
}

}  // namespace

void read_value(SceneLoad& load, const YamlNode& node, const Range&, CameraMeshPointer& mesh) {
  CameraMeshText text;
  const Fields fields = read_described(load, node, kWhat, text);
  const bool by_uv = text.settings.order == FaceOrder::uv;
  if (by_uv)
    for (const SeeingMesh& placed : text.files.meshes)
      if (placed.mesh->uvs.empty())
        throw Error(node.where(),
                    "'order: uv' needs texture coordinates, which a mesh of the camera has not");
  load.warn_if_unused(fields, "smooth", !by_uv, "faces see along one normal; 'order: uv' has several");
  mesh = std::make_shared<const CameraMesh>(std::move(text.files.meshes), text.settings);
}

std::string schema_of(Schema& schema, const Range&, const CameraMeshPointer&) {
  return schema.map(kWhat, CameraMeshText{});
}

}  // namespace oktett
