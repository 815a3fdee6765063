#pragma once
/// \file What readers of mesh files share: the mesh before the files that it names are read; failures while a
/// file is read in parallel, of which the first one in the file counts, whichever task finds it; and numbers
/// in text. Within io/ only.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/mesh.h"
#include "io/text/number.h"
#include "io/text/scan.h"

namespace oktett {

/// How a mesh file is taken apart. The result does not depend on it; tests use it to reach corner cases.
struct MeshReadOptions {
  /// Bytes that one task reads at a time, rounded up to whole lines or records.
  std::size_t chunk_bytes = std::size_t{1} << 20;
  /// The most positions, normals, uvs or triangles there may be: what 32-bit indices reach beside kNoId.
  std::size_t max_elements = 0xfffffffeu;
};

/// Words at a place in the text.
struct MeshStatement {
  /// Of what no statement says.
  static constexpr std::uint64_t kNowhere = UINT64_MAX;

  std::uint64_t at = kNowhere;  ///< bytes from the start of the text
  std::string words;
  TextPosition position;  ///< of `at`; not filled in by all readers
};

/// Depends on the content of the mesh file alone.
struct ParsedMesh {
  TriangleMesh mesh;
  Column<std::uint32_t> strokes;         ///< points and lines: two vertices of each, the same of a point
  Column<std::uint16_t> stroke_slots;    ///< one for each, or empty
  std::vector<MeshStatement> libraries;  ///< what follows `mtllib` in an OBJ file
  std::vector<MeshStatement> materials;  ///< names of the material slots of the mesh
  std::vector<MeshStatement> textures;   ///< file names of images, each a slot, where there are no materials
  std::vector<MeshStatement> notices;    ///< warnings
  bool has_faces = true;
};

/// What is wrong at a place in the text, thrown by the readers of a chunk. Lines are counted only when the
/// failure is reported.
struct MeshFailure {
  const char* where = nullptr;
  std::string message;
};

/// Keeps the failure that comes first in the text.
inline void keep_first(std::optional<MeshFailure>& first, const char* where, std::string message) {
  if (!first || where < first->where) first = MeshFailure{where, std::move(message)};
}
inline void keep_first(std::optional<MeshFailure>& first, const std::optional<MeshFailure>& other) {
  if (other) keep_first(first, other->where, other->message);
}

/// How often a text holds something that is read with a warning, and where first.
struct Tally {
  std::uint64_t count = 0;
  const char* first = nullptr;

  void add(const char* where) {
    if (count++ == 0) first = where;
  }
  /// That of what follows.
  Tally& operator+=(const Tally& later) {
    if (count == 0) first = later.first;
    count += later.count;
    return *this;
  }
};

/// What of a mesh is read with a warning.
struct MeshOddities {
  Tally crossings;    ///< faces that cross themselves
  Tally small_faces;  ///< faces of fewer than three corners
  Tally short_lines;  ///< lines of fewer than two vertices
  Tally bad_normals;  ///< normals that are not finite
  Tally no_normals;   ///< corners that name a normal where the file defines none
  Tally no_uvs;       ///< the same of texture coordinates

  /// Those of what follows.
  MeshOddities& operator+=(const MeshOddities& later);
  /// Calls note(where, words) for each that there is.
  void report(const std::function<void(const char*, std::string)>& note) const;
};

[[noreturn]] inline void stop_at(const char* where, std::string message) {
  throw MeshFailure{where, std::move(message)};
}
/// The passes read the same bytes unless someone writes to the file at the same time.
[[noreturn]] inline void stop_changed(const char* where) {
  stop_at(where, "the file changed while it was read");
}

/// Throws the Error of a failure: with its line in `text`, or with its byte.
[[noreturn]] void fail_at_line(const std::string& path, std::string_view text, const MeshFailure& failure);
[[noreturn]] void fail_at_byte(const std::string& path, std::string_view text, const MeshFailure& failure);

/// Throws Error if there are more than `most` of `what`.
void check_limit(const std::string& path, std::uint64_t count, const char* what, std::size_t most);

/// A name between quotes for a message, shortened, with a `?` for each control character.
std::string quote_name(std::string_view text);
/// The word at `p` in the same way, with a `?` for each byte that is not ASCII too.
std::string quote_word(const char* p);

/// Beyond it, products of coordinates overflow in the tests of boxes (docs/numerics.md, Domain).
inline constexpr float kMostCoordinate = 1e30f;

/// False for NaN, too.
inline bool is_coordinate(float x) { return std::abs(x) <= kMostCoordinate; }

/// Throws the failure of the number at `p`.
[[noreturn]] void stop_at_number(const char* p, NumberProblem problem);
/// Throws the failure of the coordinate `x` at `p`.
[[noreturn]] void stop_at_coordinate(const char* p, float x);

/// The greatest magnitude of a texture coordinate: any finite number will do.
inline constexpr float kMostUv = std::numeric_limits<float>::max();

/// What is wrong with the coordinate `x`, which stands in no text.
std::string bad_coordinate(float x);

/// Reads the number at `p` and returns its end. Throws MeshFailure if there is none.
inline const char* read_number(const char* p, float& x) {
  NumberProblem problem = NumberProblem::none;
  const char* end = scan_float(p, x, problem);
  if (end == nullptr) stop_at_number(p, problem);
  return end;
}

/// The same; throws also if is_coordinate does not hold.
inline const char* read_coordinate(const char* p, float& x) {
  const char* end = read_number(p, x);
  if (!is_coordinate(x)) stop_at_coordinate(p, x);
  return end;
}

/// The same, less `centre`, in double before it is rounded.
inline const char* read_coordinate_from(double centre, const char* p, float& x) {
  const char* const end = read_coordinate(p, x);
  if (centre == 0) return end;
  double exact = 0;
  scan_double(p, exact);
  x = static_cast<float>(exact - centre);
  return end;
}

/// Like read_number; throws also if the number is not finite.
inline const char* read_uv_coordinate(const char* p, float& x) {
  const char* end = read_number(p, x);
  if (!std::isfinite(x)) stop_at_coordinate(p, x);
  return end;
}

}  // namespace oktett
