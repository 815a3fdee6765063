#include "io/mesh/numbers.h"
#include "io/obj/chunk.h"

namespace oktett {
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

void read_vertices(ObjChunk& chunk, TriangleMesh& mesh) {
  ObjCounts next = chunk.before, last = next;
  last += chunk.counts;
  read_lines(chunk, [&](const char* p) {
    // The element for the values at `at`.
    const auto place = [](auto& column, std::uint64_t& i, std::uint64_t end, const char* at) -> auto& {
      if (i == end) stop_changed(at);
      return column[i++];
    };
    if (p[0] != 'v') return p;
    if (is_delimiter(p + 1))
      return read_vector<read_coordinate>(p + 1,
                                          place(mesh.positions, next.positions, last.positions, p + 1));
    if (p[1] == 'n' && is_delimiter(p + 2))
      return read_vector<read_number>(p + 2, place(mesh.normals, next.normals, last.normals, p + 2));
    if (p[1] == 't' && is_delimiter(p + 2)) return read_uv(p + 2, place(mesh.uvs, next.uvs, last.uvs, p + 2));
    return p;
  });
}

}  // namespace oktett
