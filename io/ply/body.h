#pragma once
/// \file The elements of a PLY file, in text or in bytes, on their way into a mesh.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "io/mesh/polygon.h"
#include "io/ply/attributes.h"
#include "io/ply/header.h"

namespace oktett {

/// A run of whole records of an element.
struct PlyChunk {
  const char* begin = nullptr;
  const char* end = nullptr;
  std::uint64_t first = 0;  ///< record of the element
  std::uint64_t records = 0;
  // Of elements that make triangles. `uvs` are those of corners.
  std::uint64_t triangles = 0, triangles_before = 0;
  std::uint64_t uvs = 0, uvs_before = 0;
  MeshOddities oddities{};
  std::optional<MeshFailure> failure{};  ///< the first one
};

/// What a mesh takes of vertices, in this order: x y z, nx ny nz, u v. Where these begin.
inline constexpr std::size_t kPlyRoles = 8, kPlyNormals = 3, kPlyUvs = 6;

/// An element and where it stands.
struct PlyPart {
  const PlyElement* element = nullptr;
  std::vector<PlyChunk> chunks;
  // Only in bytes, if all records have the same size; else `stride` is 0.
  std::size_t stride = 0;
  std::vector<std::size_t> offsets;  ///< of each property in a record
  std::vector<PlyExtra> extras;      ///< what becomes an attribute; in place when records are read
};

struct PlyVertices : PlyPart {
  /// The property of each role, or PlyElement::kNone.
  std::array<int, kPlyRoles> roles{};
  bool has_normals = false, has_uvs = false;
};

/// `face`, or `tristrips`, whose lists hold an index -1 between strips.
struct PlyFaces : PlyPart {
  bool strips = false;
  int indices = PlyElement::kNone;
  int texcoords = PlyElement::kNone;
};

/// `edge`: the properties that name its two vertices.
struct PlyEdges : PlyPart {
  std::array<std::size_t, 2> ends{};
  std::uint64_t before = 0;  ///< edges of other elements before it
};

/// Where the columns of vertices stand.
struct PlyVertexColumns {
  float* at(std::size_t role, std::uint64_t vertex) const {
    return base[role] == nullptr ? nullptr : base[role] + vertex * step[role];
  }
  std::array<float*, kPlyRoles> base{};  ///< null for what is not read
  std::array<std::size_t, kPlyRoles> step{};
  Vec3d centre{};  ///< what is taken off positions before they are rounded
  bool is_far() const { return !(centre == Vec3d{}); }
};

/// Writes the triangles of a chunk to a mesh whose columns have their final size.
class PlyFaceWriter {
 public:
  PlyFaceWriter(const PlyFaces& faces, const PlyChunk& chunk, TriangleMesh& mesh)
      : strips_(faces.strips),
        vertex_count_(mesh.positions.size()),
        mesh_(mesh),
        next_(chunk.triangles_before),
        last_(next_ + chunk.triangles),
        next_uv_(chunk.uvs_before),
        last_uv_(next_uv_ + chunk.uvs) {}

  /// Begins the record at `where`.
  void begin(const char* where);
  void add_index(std::int64_t index, const char* where);
  /// Throws MeshFailure if there is no such vertex.
  void check_index(std::int64_t index, const char* where) const;
  /// Texture coordinates of the corners, two for each.
  void add_uv(float x) { uvs_.push_back(x); }
  void end();

  std::uint64_t vertex_count() const { return vertex_count_; }
  /// Of the faces so far.
  const MeshOddities& oddities() const { return oddities_; }
  /// Sets the number of an extra for all triangles of the record that has ended.
  void put(const PlyExtra& extra, double x) const {
    for (std::uint64_t i = first_; i < next_; ++i) extra.put(i, x);
  }
  /// The number of the next triangle.
  std::uint64_t next() const { return next_; }
  /// The indices of the next `count` triangles, which the caller fills in.
  std::uint32_t* take_triangles(std::uint64_t count, const char* where);

 private:
  void write(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  void write_strips();
  void write_polygon();

  const bool strips_;
  const std::uint64_t vertex_count_;
  TriangleMesh& mesh_;
  std::uint64_t next_;
  std::uint64_t first_ = 0;  ///< of the record
  const std::uint64_t last_;
  std::uint64_t next_uv_;
  const std::uint64_t last_uv_;
  const char* where_ = nullptr;
  std::vector<std::uint32_t> corners_;
  std::vector<float> uvs_;
  std::vector<Vec3f> points_;
  PolygonTriangulator triangulator_;
  MeshOddities oddities_;
};

/// Writes the ends of edges to a column of two per edge that has its final size.
class PlyEdgeWriter {
 public:
  PlyEdgeWriter(const PlyEdges& edges, const PlyChunk& chunk, std::uint64_t vertices,
                Column<std::uint32_t>& ends)
      : vertices_(vertices), next_(ends.data() + 2 * (edges.before + chunk.first)) {}

  /// The next end, in the order of the file. Throws MeshFailure if there is no such vertex.
  void add(std::int64_t index, const char* where);

 private:
  std::uint64_t vertices_;
  std::uint32_t* next_;
};

/// Throws MeshFailure if there is no such vertex.
void check_ply_index(std::int64_t index, std::uint64_t vertices, const char* where);

/// Triangles of a polygon; none if it has too few corners.
std::uint64_t count_polygon(std::uint64_t corners);
class StripCounter {
 public:
  void add(std::int64_t index) {
    length_ = index == -1 ? 0 : length_ + 1;
    triangles += length_ > 2 ? 1 : 0;
  }
  std::uint64_t triangles = 0;

 private:
  std::uint64_t length_ = 0;
};

/// Throws MeshFailure if a face of `corners` cannot have `values` texture coordinates.
void check_texcoords(std::uint64_t values, std::uint64_t corners, const char* where);

/// How the elements are laid out in the file. The functions throw MeshFailure.
class PlyBody {
 public:
  virtual ~PlyBody() = default;

  /// Fills in where all parts stand, which are those of the elements of the header in their order. Returns
  /// how much follows them: lines, or bytes.
  virtual std::uint64_t locate(std::vector<PlyPart*>& parts) = 0;
  /// Fills in the triangles and uvs of each chunk, or its failure.
  virtual void count_faces(PlyFaces& faces) const = 0;
  virtual void read_vertices(const PlyVertices& vertices, const PlyChunk& chunk,
                             const PlyVertexColumns& columns) const = 0;
  virtual void read_faces(const PlyFaces& faces, const PlyChunk& chunk, PlyFaceWriter& writer) const = 0;
  virtual void read_edges(const PlyEdges& edges, const PlyChunk& chunk, PlyEdgeWriter& writer) const = 0;
};

/// `text` is that of the whole file.
std::unique_ptr<PlyBody> make_ascii_body(const PlyHeader& header, std::string_view text,
                                         std::size_t chunk_bytes);
std::unique_ptr<PlyBody> make_binary_body(const PlyHeader& header, std::string_view text,
                                          std::size_t chunk_bytes);

}  // namespace oktett
