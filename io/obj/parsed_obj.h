#pragma once
/// \file OBJ files before and after the MTL files that they name are read. Within io/ only.
///
/// The text is cut into chunks of whole lines, and each is counted, so that the second pass can write every
/// element straight to its place. The first pass collects rare statements on the way.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "io/mesh/polygon.h"
#include "io/mesh/reading.h"
#include "io/obj/colors.h"
#include "io/obj/obj.h"

namespace oktett {

using ObjOptions = MeshReadOptions;

/// As find_obj_errors(path).
std::vector<Error> find_obj_errors(const std::string& path, const ObjOptions& options);

/// As load_obj(path).
ObjFile load_obj(const std::string& path, const ObjOptions& options);

struct ObjCounts {
  std::uint64_t positions = 0;
  std::uint64_t uvs = 0;
  std::uint64_t normals = 0;
  std::uint64_t faces = 0;
  std::uint64_t triangles = 0;
  std::uint64_t strokes = 0;  ///< points of `p`, and parts of lines of `l`
  std::uint64_t painted = 0;  ///< colours of `#MRGB`

  ObjCounts& operator+=(const ObjCounts& b) {
    positions += b.positions, uvs += b.uvs, normals += b.normals, faces += b.faces, triangles += b.triangles;
    strokes += b.strokes, painted += b.painted;
    return *this;
  }
};

/// A `usemtl`: the triangles from `triangle` and the strokes from `stroke` on have the material `name`.
struct ObjMaterialUse {
  const char* where;
  std::string_view name;
  std::uint64_t triangle, stroke;  ///< counted from the start of the chunk
};

/// A `mtllib` with all that follows it on its line.
struct ObjLibrary {
  const char* where;
  std::string_view names;
};

/// The first statement of a kind that is left out.
struct ObjSkipped {
  const char* where;
  std::string_view keyword;
};

/// A `{` or `}`.
struct ObjBrace {
  const char* where = nullptr;
  bool open = false;
};

/// Most failures of a chunk that are kept where all are gathered.
inline constexpr std::size_t kMostObjFailures = 1000;

/// A run of whole lines and what the first pass finds in it.
struct ObjChunk {
  void fail(const char* where, std::string message) {
    if (gathers) failures.push_back({where, message});
    keep_first(failure, where, std::move(message));
  }
  /// Whether there is more to find after a failure.
  bool goes_on() const { return gathers && failures.size() < kMostObjFailures; }

  const char* begin = nullptr;
  const char* end = nullptr;
  ObjCounts counts;          ///< within the chunk
  ObjCounts before;          ///< in all chunks before it
  bool has_slash = false;    ///< some face refers to normals or uvs
  bool has_strokes = false;  ///< some line is a `p` or `l`, of whatever vertices
  bool has_colors = false;   ///< its first vertex has one
  bool has_levels = false;   ///< which is one of bytes
  ObjColors colors;          ///< found in the second pass
  std::vector<ObjMaterialUse> material_uses;
  std::vector<ObjLibrary> libraries;
  std::vector<ObjSkipped> skipped;  ///< each keyword once, in order; not many more than kMaxSkippedKeywords
  ObjBrace first_brace;
  ObjBrace last_brace;
  bool uses_uvs = false;               ///< found in the second pass
  bool uses_normals = false;           ///< found in the second pass
  MeshOddities oddities;               ///< found in the second pass
  std::optional<MeshFailure> failure;  ///< the first one
  bool gathers = false;                ///< lines behind a failure are read, too
  std::vector<MeshFailure> failures;   ///< all, in any order, if they are gathered
};

/// A file with more unknown keywords than this is something else; they are not listed one by one.
inline constexpr std::size_t kMaxSkippedKeywords = 32;

/// Cuts `text` into runs of whole lines of about `chunk_bytes` each.
std::vector<ObjChunk> cut_into_chunks(std::string_view text, std::size_t chunk_bytes);

/// Fills in what the first pass finds, all but `before`. The number of triangles is that of the words behind
/// `f`, less two a face.
void count_chunk(ObjChunk& chunk);

/// Fills in `before` of all chunks and returns the totals.
ObjCounts sum_counts(std::vector<ObjChunk>& chunks);

/// A brace that does not pair with another, if there is one.
std::optional<MeshFailure> find_unpaired_brace(const std::vector<ObjChunk>& chunks);

/// Calls `read` with the start of each line from `p` on; it returns where it stopped in the line. Ends at the
/// first failure and keeps it. Returns the line after it, or the end of the chunk.
template <class Read>
const char* read_lines_from(const char* p, ObjChunk& chunk, const Read& read) {
  try {
    while (p < chunk.end) {
      const char* rest = read(skip_blanks(p));
      p = next_line(is_line_end(*rest) ? rest : find_joined_line_end(rest), chunk.end);
    }
    return p;
  } catch (const MeshFailure& failure) {
    chunk.fail(failure.where, failure.message);
    return next_line(find_joined_line_end(failure.where), chunk.end);
  }
}

/// Calls `read` for the lines of the chunk up to the first failure, or for all if failures are gathered.
template <class Read>
void read_lines(ObjChunk& chunk, const Read& read) {
  const char* p = chunk.begin;
  do {
    p = read_lines_from(p, chunk, read);
  } while (p < chunk.end && chunk.goes_on());
}

/// Reads `v`, `vt` and `vn` of a counted chunk to their place in `mesh`, whose columns have their final size,
/// and colours likewise. Stops at the first failure in the chunk.
void read_vertices(ObjChunk& chunk, TriangleMesh& mesh, ObjColorColumns& colors);

/// Reads `v` of a counted chunk that read_vertices has read again, less `centre`.
void read_positions_from(const Vec3d& centre, ObjChunk& chunk, TriangleMesh& mesh);

struct ObjFaceOptions {
  /// Whether the positions are all there, so that polygons can be cut properly. If not, faces are only
  /// checked.
  bool positions_known = true;
};

/// Reads the faces of a counted chunk to their place in the index columns of the mesh, which have their final
/// size (those of normals and uvs may be empty if the file has none), and points and lines to theirs in
/// `strokes`. Stops at the first failure in the chunk.
void read_faces(ObjChunk& chunk, const ObjCounts& total, ParsedMesh& parsed, const ObjFaceOptions& options);

/// The files that the text behind `mtllib` names, relative to `directory`. Names may contain blanks: text
/// that names an existing file is one name, else a name ends at a word that ends in `.mtl`.
std::vector<std::string> split_library_names(std::string_view text, const std::string& directory);

/// Reads `path` but no MTL files. The result has the positions of all statements. Throws Error as load_obj
/// does.
ParsedMesh parse_obj(const std::string& path);

/// The second step of reading a mesh of any format: materials by the MTL files that `parsed`, which comes
/// from `path`, names, and warnings with their places. Only OBJ files name some.
MeshFile finish_mesh(const std::string& path, ParsedMesh parsed);

/// The same, where `position` finds the lines of statements. It is called in the order of the text.
MeshFile finish_mesh(const std::string& path, ParsedMesh parsed,
                     const std::function<TextPosition(std::uint64_t)>& position);

/// Gives all triangles of `mesh` their slots and lists the statements about materials; `text` begins the
/// file. More materials than slots can tell apart are noted as the failure of their chunk.
void assign_slots(std::vector<ObjChunk>& chunks, const char* text, ParsedMesh& parsed);

/// Loads the MTL files and sets materials and textures of `obj`. Appends warnings about the OBJ file to
/// `notices`, those about the MTL files to obj.warnings.
void resolve_materials(const std::vector<MeshStatement>& libraries,
                       const std::vector<MeshStatement>& materials, const std::string& obj_path, ObjFile& obj,
                       std::vector<MeshStatement>& notices);

}  // namespace oktett
