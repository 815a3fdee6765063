#include "io/obj/parsed_obj.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io/mesh/polygon.h"
#include "io/mesh/reading.h"
#include "io/text/number.h"

namespace oktett {

namespace {

constexpr const char* kBraceInBlock = "a block starts within a block; expected '}' first";
constexpr const char* kBraceAlone = "'}' without a block before it";

bool is_printable_word(std::string_view word) {
  return std::all_of(word.begin(), word.end(), [](char c) { return c > ' ' && c < '\x7f'; });
}

/// The brace of the statement at `where`; `rest` is what follows it on its line.
void note_brace(ObjChunk& chunk, const char* where, bool open, const char* rest) {
  const ObjBrace brace{where, open};
  if (chunk.first_brace.where == nullptr)
    chunk.first_brace = brace;
  else if (chunk.last_brace.open == open)
    chunk.fail(where, open ? kBraceInBlock : kBraceAlone);
  chunk.last_brace = brace;
  rest = next_word(rest);
  if (!is_line_end(*rest)) chunk.fail(rest, "expected the end of the line, found " + quote_word(rest));
}

void note_skipped(ObjChunk& chunk, const char* where, std::string_view keyword) {
  // Room for the one that is too many.
  if (chunk.skipped.size() > kMaxSkippedKeywords) return;
  for (const ObjSkipped& known : chunk.skipped)
    if (known.keyword == keyword) return;
  chunk.skipped.push_back({where, keyword});
}

/// The end of the joined line from `p` on, without a backslash at the end of the text.
const char* statement_end(const char* p) {
  const char* end = find_joined_line_end(p);
  return end > p && *end == '\0' && end[-1] == '\\' ? end - 1 : end;
}

/// A statement other than those that make up the bulk of a file.
void note_statement(ObjChunk& chunk, const char* p) {
  const std::string_view keyword = word_at(p);
  const char* rest = p + keyword.size();
  if (!is_printable_word(keyword)) {
    chunk.fail(p, "expected an OBJ keyword, found " + quote_word(p));
  } else if (keyword == "usemtl") {
    chunk.material_uses.push_back(
        {p, trimmed(rest, statement_end(p)), chunk.counts.triangles, chunk.counts.strokes});
  } else if (keyword == "mtllib") {
    chunk.libraries.push_back({p, trimmed(rest, statement_end(p))});
  } else if (keyword == "{" || keyword == "vertices{" || keyword == "triangles{") {
    note_brace(chunk, p, true, rest);
  } else if (keyword == "}") {
    note_brace(chunk, p, false, rest);
  } else if ((keyword == "vertices" || keyword == "triangles") && word_at(next_word(rest)) == "{") {
    note_brace(chunk, p, true, next_word(rest) + 1);
  } else if ((keyword == "vertices" || keyword == "triangles") && is_line_end(*next_word(rest))) {
    // The brace may stand on the next line.
  } else if (keyword != "o" && keyword != "g" && keyword != "s") {
    note_skipped(chunk, p, keyword);
  }
}

/// Counts the face at `p` and returns the end of its joined line.
const char* count_face(ObjChunk& chunk, const char* p) {
  const LineShape shape = measure_line(p);
  const std::uint64_t corners = (shape.plain() ? shape.words : count_words(p)) - 1;
  chunk.counts.triangles += corners > 2 ? corners - 2 : 0;
  ++chunk.counts.faces;
  chunk.has_slash = chunk.has_slash || shape.slash || !shape.plain();
  return shape.continued() ? find_joined_line_end(p) : shape.end;
}

/// Whether the points or the line of a `p` or `l` are at `p`.
bool is_stroke(const char* p) { return (p[0] == 'p' || p[0] == 'l') && is_delimiter(p + 1); }

/// How many strokes a `p` or `l` of so many vertices is.
std::uint64_t stroke_count(char keyword, std::uint64_t vertices) {
  return keyword == 'p' ? vertices : std::max<std::uint64_t>(vertices, 1) - 1;
}

constexpr std::string_view kPaint = "#MRGB ";

/// Colours in a comment of ZBrush: eight hexadecimal digits each, a mask and three bytes.
std::uint64_t count_paint(const char* p, const char* end) { return static_cast<std::uint64_t>(end - p) / 8; }

/// Where the digits begin in the comment at `p`; null if it is another one.
const char* paint_in(const char* p) {
  for (const char c : kPaint)
    if (*p++ != c) return nullptr;
  return skip_plain_blanks(p);
}

/// Of a comment that is no such one.
void note_comment(ObjChunk& chunk, const char* p) {
  const char* const digits = paint_in(p);
  if (digits == nullptr) return;
  const char* const end = find_line_end(digits);
  chunk.counts.painted += count_paint(digits, end);
}

/// What the first vertex of a chunk, at `p`, has behind its coordinates.
void note_first_color(ObjChunk& chunk, const char* p) {
  chunk.has_colors = count_words(p) >= 7;
  if (!chunk.has_colors) return;
  for (int k = 0; k < 4; ++k) p = next_word(p + word_at(p).size());
  std::uint8_t levels[3];
  chunk.has_levels = read_color_levels(p, levels) != nullptr;
}

/// Counts the line at `p` and returns the end of the joined line.
const char* count_line(ObjChunk& chunk, const char* p) {
  if (p[0] == 'f' && is_delimiter(p + 1)) return count_face(chunk, p);
  if (p[0] == 'v' && is_delimiter(p + 1)) {
    // Where the first vertex has a colour, most others have one.
    if (chunk.counts.positions == 0) note_first_color(chunk, p);
    ++chunk.counts.positions;
  } else if (p[0] == 'v' && p[1] == 'n' && is_delimiter(p + 2))
    ++chunk.counts.normals;
  else if (p[0] == 'v' && p[1] == 't' && is_delimiter(p + 2))
    ++chunk.counts.uvs;
  else if (is_stroke(p)) {
    chunk.has_strokes = true;
    chunk.counts.strokes += stroke_count(p[0], count_words(p) - 1);
  } else if (p[0] == '#')
    note_comment(chunk, p);
  else if (!is_line_end(p[0]))
    note_statement(chunk, p);
  const char* end = find_line_end(p);
  return end > p && end[-1] == '\\' ? find_joined_line_end(p) : end;
}

}  // namespace

std::vector<ObjChunk> cut_into_chunks(std::string_view text, std::size_t chunk_bytes) {
  std::vector<ObjChunk> chunks;
  const char* const text_end = text.data() + text.size();
  const char* begin = text.data();
  while (begin < text_end) {
    const char* end = text_end;
    if (static_cast<std::size_t>(text_end - begin) > chunk_bytes) {
      // Going on behind every backslash may make a chunk longer than need be, but never cuts a joined line.
      const char* nominal = begin + chunk_bytes;
      if (nominal[-1] == '\r' && nominal[0] == '\n') --nominal;
      const char* line_end = find_line_end(nominal);
      end = next_line(line_end, text_end);
      while (line_end > begin && line_end[-1] == '\\' && end < text_end) {
        line_end = find_line_end(end);
        end = next_line(line_end, text_end);
      }
    }
    ObjChunk& chunk = chunks.emplace_back();
    chunk.begin = begin;
    chunk.end = begin = end;
  }
  return chunks;
}

void count_chunk(ObjChunk& chunk) {
  for (const char* p = chunk.begin; p < chunk.end;) {
    p = skip_blanks(p);
    const char* end = count_line(chunk, p);
    if (*end == '\0' && end < chunk.end) chunk.fail(end, "unexpected zero byte");
    p = next_line(end, chunk.end);
  }
}

ObjCounts sum_counts(std::vector<ObjChunk>& chunks) {
  ObjCounts total;
  for (ObjChunk& chunk : chunks) {
    chunk.before = total;
    total += chunk.counts;
  }
  return total;
}

std::optional<MeshFailure> find_unpaired_brace(const std::vector<ObjChunk>& chunks) {
  ObjBrace last;
  for (const ObjChunk& chunk : chunks) {
    if (chunk.first_brace.where == nullptr) continue;
    if (chunk.first_brace.open == last.open)
      return MeshFailure{chunk.first_brace.where, last.open ? kBraceInBlock : kBraceAlone};
    last = chunk.last_brace;
  }
  if (last.open)
    return MeshFailure{last.where, "a block is not closed; expected '}' before the end of the file"};
  return std::nullopt;
}

namespace {

/// Three numbers, each read by `read`.
template <const char* read(const char*, float&)>
const char* read_vector(const char* p, Vec3f& out) {
  Vec3f v;
  p = read(skip_blanks(p), v.x);
  p = read(skip_blanks(p), v.y);
  p = read(skip_blanks(p), v.z);
  out = v;
  return skip_blanks(p);
}

const char* read_uv(const char* p, Vec2f& out) {
  Vec2f uv;
  p = skip_blanks(read_uv_coordinate(skip_blanks(p), uv.x));
  if (!is_line_end(*p) && *p != '#') p = skip_blanks(read_uv_coordinate(p, uv.y));
  out = uv;
  return p;
}

}  // namespace

namespace {

/// Reads the vertices of a chunk and the colours behind them.
class VertexReader {
 public:
  VertexReader(ObjChunk& chunk, TriangleMesh& mesh, ObjColorColumns& colors)
      : chunk_(chunk),
        mesh_(mesh),
        levels_(colors.levels.data()),
        numbers_(colors.numbers.data()),
        painted_(colors.painted.data()),
        next_(chunk.before),
        last_(next_) {
    last_ += chunk.counts;
  }

  void run() {
    chunk_.colors = {};
    read_lines(chunk_, [this](const char* p) { return read_line(p); });
  }

 private:
  const char* read_line(const char* p) {
    if (p[0] == '#' && painted_ != nullptr) read_paint(p);
    if (p[0] != 'v') return p;
    if (is_delimiter(p + 1)) return read_position(p + 1);
    if (p[1] == 'n' && is_delimiter(p + 2)) {
      Vec3f& normal = place(mesh_.normals, next_.normals, last_.normals, p + 2);
      const char* const rest = read_vector<read_number>(p + 2, normal);
      if (!is_finite(normal)) chunk_.oddities.bad_normals.add(p);
      return rest;
    }
    if (p[1] == 't' && is_delimiter(p + 2))
      return read_uv(p + 2, place(mesh_.uvs, next_.uvs, last_.uvs, p + 2));
    return p;
  }

  /// The element for the values at `at`.
  template <class T>
  static T& place(Column<T>& column, std::uint64_t& i, std::uint64_t end, const char* at) {
    if (i == end) stop_changed(at);
    return column[i++];
  }

  const char* read_position(const char* p) {
    const std::uint64_t vertex = next_.positions;
    const char* const end =
        read_vector<read_coordinate>(p, place(mesh_.positions, next_.positions, last_.positions, p));
    if (numbers_ == nullptr && levels_ == nullptr && is_line_end(*end)) return end;
    if (levels_ != nullptr)
      if (const char* const rest = read_color_levels(end, levels_ + 3 * vertex); rest && is_line_end(*rest)) {
        ++chunk_.colors.count;
        return rest;
      }
    return read_color(p, end, vertex);
  }

  /// The colour behind the coordinates of a vertex. Other numbers of them are no colours: a fourth coordinate
  /// is a weight.
  const char* read_color(const char* vertex_at, const char* p, std::uint64_t vertex) {
    float c[4];
    int count = 0;
    for (const char* end = p; count < 4 && !is_line_end(*end) && *end != '#'; ++count) {
      NumberProblem problem = NumberProblem::none;
      end = scan_float(end, c[count], problem);
      if (end == nullptr || !(c[count] >= 0 && c[count] <= std::numeric_limits<float>::max())) break;
      p = end = skip_blanks(end);
    }
    ObjColors& found = chunk_.colors;
    if (count < 3) {
      if (found.without == nullptr) found.without = vertex_at;
      if (numbers_ != nullptr) std::fill_n(numbers_ + 3 * vertex, 3, kNoObjColor);
      if (levels_ != nullptr) std::fill_n(levels_ + 3 * vertex, 3, std::uint8_t{255});
      return p;
    }
    ++found.count;
    for (std::size_t k = 0; k < 3; ++k) {
      found.greatest = std::max(found.greatest, c[k]);
      if (found.are_bytes) {
        const float level = c[k] * 255, whole = std::nearbyint(level);
        // Programs write bytes with six digits or more.
        found.are_bytes = std::abs(level - whole) <= 4e-4f;
        if (levels_ != nullptr) levels_[3 * vertex + k] = static_cast<std::uint8_t>(std::min(whole, 255.0f));
      }
      if (found.are_whole) found.are_whole = c[k] == std::nearbyint(c[k]);
      if (numbers_ != nullptr) numbers_[3 * vertex + k] = c[k];
    }
    return p;
  }

  void read_paint(const char* p) {
    const char* digits = paint_in(p);
    if (digits == nullptr) return;
    for (std::uint64_t left = count_paint(digits, find_line_end(digits)); left > 0; --left, digits += 8) {
      if (next_.painted == last_.painted) stop_changed(p);
      std::uint8_t* const out = painted_ + 3 * next_.painted++;
      for (int k = 0; k < 3; ++k)
        out[k] = static_cast<std::uint8_t>(16 * digit(digits[2 * k + 2]) + digit(digits[2 * k + 3]));
    }
  }

  static int digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : 0;
  }

  ObjChunk& chunk_;
  TriangleMesh& mesh_;
  std::uint8_t* const levels_;
  float* const numbers_;
  std::uint8_t* const painted_;
  ObjCounts next_, last_;
};

}  // namespace

void read_vertices(ObjChunk& chunk, TriangleMesh& mesh, ObjColorColumns& colors) {
  VertexReader(chunk, mesh, colors).run();
}

void read_positions_from(const Vec3d& centre, ObjChunk& chunk, TriangleMesh& mesh) {
  std::uint64_t next = chunk.before.positions;
  const std::uint64_t last = next + chunk.counts.positions;
  read_lines(chunk, [&](const char* p) {
    if (p[0] != 'v' || !is_delimiter(p + 1)) return p;
    if (next == last) stop_changed(p);
    Vec3f v;
    ++p;
    for (int k = 0; k < 3; ++k) p = read_coordinate_from(centre[k], skip_blanks(p), v[k]);
    mesh.positions[next++] = v;
    return skip_blanks(p);
  });
}

namespace {

struct Corner {
  std::uint32_t position = kNoId;
  std::uint32_t uv = kNoId;
  std::uint32_t normal = kNoId;
};

class FaceReader {
 public:
  FaceReader(ObjChunk& chunk, const ObjCounts& total, ParsedMesh& parsed, const ObjFaceOptions& options)
      : chunk_(chunk),
        total_(total),
        mesh_(parsed.mesh),
        strokes_(parsed.strokes),
        options_(options),
        // Triangles without slashes are read by the short way, which writes positions alone.
        short_way_(mesh_.normal_indices.empty() && mesh_.uv_indices.empty()),
        next_(chunk.before),
        last_triangle_(chunk.before.triangles + chunk.counts.triangles),
        last_stroke_(chunk.before.strokes + chunk.counts.strokes) {}

  void run() {
    read_lines(chunk_, [this](const char* p) {
      if (p[0] == 'f' && is_delimiter(p + 1)) return read_face(p);
      if (p[0] == 'v') count_vertex(p);
      return is_stroke(p) ? read_stroke(p) : p;
    });
  }

 private:
  /// Negative indices count from the vertices so far.
  void count_vertex(const char* p) {
    if (is_delimiter(p + 1))
      ++next_.positions;
    else if (p[1] == 't' && is_delimiter(p + 2))
      ++next_.uvs;
    else if (p[1] == 'n' && is_delimiter(p + 2))
      ++next_.normals;
  }

  /// The corners behind a keyword of one letter.
  const char* read_corners(const char* p) {
    corners_.clear();
    const char* end = next_word(p + 1);
    while (!is_line_end(*end)) {
      Corner corner;
      end = next_word(read_corner(end, corner));
      corners_.push_back(corner);
    }
    return end;
  }

  /// Points, or a line from vertex to vertex. Their uv has no use.
  const char* read_stroke(const char* p) {
    const bool used_uvs = chunk_.uses_uvs, used_normals = chunk_.uses_normals;
    const char* const end = read_corners(p);
    chunk_.uses_uvs = used_uvs, chunk_.uses_normals = used_normals;
    const std::uint64_t count = stroke_count(p[0], corners_.size());
    if (count == 0) chunk_.oddities.short_lines.add(p);
    if (count > last_stroke_ - next_.strokes) stop_changed(p);
    std::uint32_t* out = strokes_.data() + 2 * next_.strokes;
    for (std::uint64_t i = 0; i < count; ++i) {
      *out++ = corners_[i].position;
      *out++ = corners_[p[0] == 'p' ? i : i + 1].position;
    }
    next_.strokes += count;
    return end;
  }

  const char* read_face(const char* p) {
    if (short_way_)
      if (const char* rest = read_plain_triangle(p + 1)) return rest;
    const char* const end = read_corners(p);
    if (corners_.size() < 3) {
      chunk_.oddities.small_faces.add(p);
      return end;
    }
    if (corners_.size() - 2 > last_triangle_ - next_.triangles) stop_changed(p);
    write_polygon(p);
    return end;
  }

  /// Three plain positive indices and nothing else, or null.
  const char* read_plain_triangle(const char* p) {
    std::uint64_t index[3];
    for (std::uint64_t& i : index) {
      while (is_blank(*p)) ++p;
      const char* end = scan_whole(p, i);
      if (i - 1 >= total_.positions || end == p || !(is_blank(*end) || is_line_end(*end))) return nullptr;
      p = end;
    }
    while (is_blank(*p)) ++p;
    if (!is_line_end(*p) || next_.triangles == last_triangle_) return nullptr;
    std::uint32_t* out = mesh_.indices.data() + 3 * next_.triangles++;
    for (int k = 0; k < 3; ++k) out[k] = static_cast<std::uint32_t>(index[k] - 1);
    return p;
  }

  const char* read_corner(const char* p, Corner& corner) {
    const char* const start = p;
    p = read_index(p, "vertex", total_.positions, next_.positions, corner.position);
    if (*p == '/') {
      ++p;
      if (*p != '/' && !is_delimiter(p))
        p = read_index_if_any(p, "uv", total_.uvs, next_.uvs, corner.uv, chunk_.oddities.no_uvs);
      if (*p == '/' && !is_delimiter(++p))
        p = read_index_if_any(p, "normal", total_.normals, next_.normals, corner.normal,
                              chunk_.oddities.no_normals);
    }
    if (!is_delimiter(p)) stop_at_corner(start);
    chunk_.uses_uvs = chunk_.uses_uvs || corner.uv != kNoId;
    chunk_.uses_normals = chunk_.uses_normals || corner.normal != kNoId;
    return p;
  }

  static const char* read_index(const char* p, const char* kind, std::uint64_t total, std::uint64_t so_far,
                                std::uint32_t& index) {
    const bool negative = *p == '-';
    const char* first = p + (negative || *p == '+' ? 1 : 0);
    std::uint64_t value = 0;
    const char* end = scan_whole(first, value);
    if (end == first) stop_at_corner(p);
    if (value == 0 || value > (negative ? so_far : total)) stop_at_index(p, end, kind, total, so_far);
    index = static_cast<std::uint32_t>(negative ? so_far - value : value - 1);
    return end;
  }

  /// The same for what faces may name though the file defines none at all.
  static const char* read_index_if_any(const char* p, const char* kind, std::uint64_t total,
                                       std::uint64_t so_far, std::uint32_t& index, Tally& missing) {
    if (total > 0) return read_index(p, kind, total, so_far, index);
    missing.add(p);
    std::uint64_t value = 0;
    const char* const first = p + (*p == '-' || *p == '+' ? 1 : 0);
    const char* const end = scan_whole(first, value);
    if (end == first) stop_at_corner(p);
    return end;
  }

  [[noreturn]] static void stop_at_corner(const char* p) {
    stop_at(p, "expected a corner such as 1, 1/2, 1//3 or 1/2/3, found " + quote_word(p));
  }

  [[noreturn]] static void stop_at_index(const char* p, const char* end, const char* kind,
                                         std::uint64_t total, std::uint64_t so_far) {
    const std::string text(p, static_cast<std::size_t>(end - p));
    const std::string what =
        std::string(kind) + " index " + (text.size() > 40 ? text.substr(0, 40) + "..." : text);
    if (text.find_first_not_of("+-0") == std::string::npos)
      stop_at(p, what + " is not allowed; indices count from 1");
    if (text[0] == '-')
      stop_at(p, what + " is out of range: only " + std::to_string(so_far) + " defined before it");
    stop_at(p, what + " is out of range: the file defines " + std::to_string(total));
  }

  void write_polygon(const char* where) {
    if (corners_.size() == 3 || !options_.positions_known) {
      for (std::size_t i = 2; i < corners_.size(); ++i)
        write_triangle(corners_[0], corners_[i - 1], corners_[i]);
      return;
    }
    points_.clear();
    for (const Corner& corner : corners_) points_.push_back(mesh_.positions[corner.position]);
    const std::span<const std::uint32_t> cut = triangulator_.run(points_);
    if (triangulator_.crosses_itself()) chunk_.oddities.crossings.add(where);
    for (std::size_t i = 0; i < cut.size(); i += 3)
      write_triangle(corners_[cut[i]], corners_[cut[i + 1]], corners_[cut[i + 2]]);
  }

  void write_triangle(const Corner& a, const Corner& b, const Corner& c) {
    const std::size_t at = 3 * next_.triangles++;
    const Corner* const corners[3] = {&a, &b, &c};
    for (std::size_t k = 0; k < 3; ++k) {
      mesh_.indices[at + k] = corners[k]->position;
      if (!mesh_.uv_indices.empty()) mesh_.uv_indices[at + k] = corners[k]->uv;
      if (!mesh_.normal_indices.empty()) mesh_.normal_indices[at + k] = corners[k]->normal;
    }
  }

  ObjChunk& chunk_;
  const ObjCounts& total_;
  TriangleMesh& mesh_;
  Column<std::uint32_t>& strokes_;
  const ObjFaceOptions options_;
  const bool short_way_;
  ObjCounts next_;
  const std::uint64_t last_triangle_, last_stroke_;
  std::vector<Corner> corners_;
  std::vector<Vec3f> points_;
  PolygonTriangulator triangulator_;
};

}  // namespace

void read_faces(ObjChunk& chunk, const ObjCounts& total, ParsedMesh& parsed, const ObjFaceOptions& options) {
  FaceReader(chunk, total, parsed, options).run();
}

}  // namespace oktett
