#include "io/ply/ply.h"

#include <limits>

#include "io/mesh/vertices.h"

namespace oktett {
namespace {

class PlyWriting {
 public:
  PlyWriting(const std::string& path, const UnifiedMesh& mesh, bool ascii)
      : out_(path), mesh_(mesh), ascii_(ascii) {}

  void run() {
    write_header();
    for (std::size_t i = 0; i < mesh_.positions.size(); ++i) write_vertex(i);
    for (std::size_t i = 0; i < mesh_.indices.size(); i += 3) write_face(&mesh_.indices[i]);
    out_.commit();
  }

 private:
  void write_header() {
    out_.text("ply\nformat ").text(ascii_ ? "ascii" : "binary_little_endian").text(" 1.0\n");
    out_.text("comment Written by Oktett\nelement vertex ").number(mesh_.positions.size()).text("\n");
    const auto properties = [&](std::initializer_list<const char*> names) {
      for (const char* name : names) out_.text("property float ").text(name).text("\n");
    };
    properties({"x", "y", "z"});
    if (!mesh_.normals.empty()) properties({"nx", "ny", "nz"});
    if (!mesh_.uvs.empty()) properties({"s", "t"});
    out_.text("element face ").number(mesh_.indices.size() / 3).text("\nproperty list uchar ");
    // Most readers know int here, and some nothing else.
    const bool is_small = mesh_.positions.size() <= std::numeric_limits<std::int32_t>::max();
    out_.text(is_small ? "int" : "uint").text(" vertex_indices\nend_header\n");
  }

  template <class T>
  void write(const T& value) {
    if (!ascii_)
      out_.bytes(value);
    else
      out_.text(is_first_ ? "" : " ").number(value);
    is_first_ = false;
  }
  void end_record() {
    if (ascii_) out_.text("\n");
    is_first_ = true;
  }

  void write_vertex(std::size_t i) {
    const auto vector = [this](const Vec3f& v) { write(v.x), write(v.y), write(v.z); };
    vector(mesh_.positions[i]);
    if (!mesh_.normals.empty()) vector(mesh_.normals[i]);
    if (!mesh_.uvs.empty()) write(mesh_.uvs[i].x), write(mesh_.uvs[i].y);
    end_record();
  }
  void write_face(const std::uint32_t* corners) {
    write(std::uint8_t{3});
    for (int k = 0; k < 3; ++k) write(corners[k]);
    end_record();
  }

  MeshOutput out_;
  const UnifiedMesh& mesh_;
  const bool ascii_;
  bool is_first_ = true;  ///< of a record
};

}  // namespace

MeshLosses write_ply(const std::string& path, const MeshFile& file, bool ascii) {
  const UnifiedMesh mesh = unify_vertices(file.mesh);
  PlyWriting(path, mesh, ascii).run();
  MeshLosses losses;
  mesh.note_changes(file.mesh.positions.size(), losses);
  return losses;
}

}  // namespace oktett
