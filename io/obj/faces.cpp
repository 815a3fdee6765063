#include <span>
#include <string>
#include <vector>

#include "io/mesh/polygon.h"
#include "io/obj/chunk.h"
#include "io/text/number.h"

namespace oktett {
namespace {

struct Corner {
  std::uint32_t position = kNoId;
  std::uint32_t uv = kNoId;
  std::uint32_t normal = kNoId;
};

class FaceReader {
 public:
  FaceReader(ObjChunk& chunk, const ObjCounts& total, TriangleMesh& mesh, const ObjFaceOptions& options)
      : chunk_(chunk),
        total_(total),
        mesh_(mesh),
        options_(options),
        // Triangles without slashes are read by the short way, which writes positions alone.
        short_way_(mesh.normal_indices.empty() && mesh.uv_indices.empty()),
        next_(chunk.before),
        last_triangle_(chunk.before.triangles + chunk.counts.triangles) {}

  void run() {
    read_lines(chunk_, [this](const char* p) {
      if (p[0] == 'f' && is_delimiter(p + 1)) return read_face(p);
      if (p[0] == 'v') count_vertex(p);
      return p;
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

  const char* read_face(const char* p) {
    if (short_way_)
      if (const char* rest = read_plain_triangle(p + 1)) return rest;
    corners_.clear();
    const char* end = next_word(p + 1);
    while (!is_line_end(*end)) {
      Corner corner;
      end = next_word(read_corner(end, corner));
      corners_.push_back(corner);
    }
    if (corners_.size() < 3)
      stop_at(p, "a face needs at least 3 corners, found " + std::to_string(corners_.size()));
    if (corners_.size() - 2 > last_triangle_ - next_.triangles) stop_changed(p);
    write_polygon();
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
      if (*p != '/' && !is_delimiter(p)) p = read_index(p, "uv", total_.uvs, next_.uvs, corner.uv);
      if (*p == '/' && !is_delimiter(++p))
        p = read_index(p, "normal", total_.normals, next_.normals, corner.normal);
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

  void write_polygon() {
    if (corners_.size() == 3 || !options_.positions_known) {
      for (std::size_t i = 2; i < corners_.size(); ++i)
        write_triangle(corners_[0], corners_[i - 1], corners_[i]);
      return;
    }
    points_.clear();
    for (const Corner& corner : corners_) points_.push_back(mesh_.positions[corner.position]);
    const std::span<const std::uint32_t> cut = triangulator_.run(points_);
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
  const ObjFaceOptions options_;
  const bool short_way_;
  ObjCounts next_;
  const std::uint64_t last_triangle_;
  std::vector<Corner> corners_;
  std::vector<Vec3f> points_;
  PolygonTriangulator triangulator_;
};

}  // namespace

void read_faces(ObjChunk& chunk, const ObjCounts& total, TriangleMesh& mesh, const ObjFaceOptions& options) {
  FaceReader(chunk, total, mesh, options).run();
}

}  // namespace oktett
