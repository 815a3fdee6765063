#include "io/obj/write_obj.h"

#include <filesystem>
#include <optional>

namespace oktett {
namespace {

namespace fs = std::filesystem;

void write_vector(MeshOutput& out, const char* keyword, const Vec3f& v) {
  out.text(keyword).number(v.x).text(" ").number(v.y).text(" ").number(v.z).text("\n");
}

/// The index of a corner, counted from 1; nothing where there is none.
void write_index(MeshOutput& out, const Column<std::uint32_t>& indices, std::size_t corner) {
  if (!indices.empty() && indices[corner] != kNoId) out.number(std::uint64_t{indices[corner]} + 1);
}

bool has_index(const Column<std::uint32_t>& indices, std::size_t corner) {
  return !indices.empty() && indices[corner] != kNoId;
}

void write_faces(MeshOutput& out, const TriangleMesh& mesh, const std::vector<std::string>& names) {
  std::uint32_t shown = kNoId;
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    const std::uint32_t slot = mesh.material_slots.empty() ? 0 : mesh.material_slots[i];
    if (slot != shown && slot < names.size()) out.text("usemtl ").text(names[slot]).text("\n");
    shown = slot;
    out.text("f");
    for (std::size_t corner = 3 * i; corner < 3 * i + 3; ++corner) {
      out.text(" ").number(std::uint64_t{mesh.indices[corner]} + 1);
      const bool has_normal = has_index(mesh.normal_indices, corner);
      if (has_normal || has_index(mesh.uv_indices, corner)) out.text("/");
      write_index(out, mesh.uv_indices, corner);
      if (has_normal) out.text("/");
      write_index(out, mesh.normal_indices, corner);
    }
    out.text("\n");
  }
}

void write_mesh(MeshOutput& out, const TriangleMesh& mesh, const std::vector<std::string>& names) {
  for (const Vec3f& p : mesh.positions) write_vector(out, "v ", p);
  if (!mesh.uv_indices.empty())
    for (const Vec2f& uv : mesh.uvs) out.text("vt ").number(uv.x).text(" ").number(uv.y).text("\n");
  if (!mesh.normal_indices.empty())
    for (const Vec3f& n : mesh.normals) write_vector(out, "vn ", n);
  write_faces(out, mesh, names);
}

}  // namespace

MeshLosses write_obj(const std::string& path, const MeshFile& file) {
  MeshLosses losses;
  MeshOutput out(path);
  out.text("# Written by Oktett\n");
  std::optional<MeshOutput> library;
  const std::vector<std::string> names = mtl_names(file.materials);
  if (!names.empty()) {
    const std::string library_path = fs::path(path).replace_extension(".mtl").string();
    library.emplace(library_path);
    write_mtl(*library, library_path, file, names, losses);
    out.text("mtllib ").text(fs::path(library_path).filename().string()).text("\n");
  }
  write_mesh(out, file.mesh, names);
  out.flush();
  // Behind all that takes much space, so that seldom one file is new and the other is not.
  if (library) library->commit();
  out.commit();
  return losses;
}

}  // namespace oktett
