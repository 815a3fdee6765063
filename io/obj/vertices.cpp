#include <cmath>

#include "io/obj/chunk.h"
#include "io/text/number.h"

namespace oktett {
namespace {

/// Beyond it, products of coordinates overflow in the tests of boxes (docs/numerics.md, Domain).
constexpr float kMostCoordinate = 1e30f;

[[noreturn]] void stop_at_number(const char* p, NumberProblem problem) {
  if (is_line_end(*p) || *p == '#') stop_at(p, "expected a number, found the end of the line");
  if (problem == NumberProblem::overflow)
    stop_at(p, "expected a finite number, but " + quote_word(p) + " is out of range");
  stop_at(p, "expected a number, found " + quote_word(p));
}

inline const char* read_number(const char* p, float& x) {
  p = skip_blanks(p);
  NumberProblem problem = NumberProblem::none;
  const char* end = scan_float(p, x, problem);
  if (end == nullptr) stop_at_number(p, problem);
  return end;
}

const char* read_coordinate(const char* p, float& x) {
  const char* end = read_number(p, x);
  if (!std::isfinite(x)) {
    p = skip_blanks(p);
    stop_at(p, "expected a finite number, found " + quote_word(p));
  }
  if (std::abs(x) > kMostCoordinate) {
    p = skip_blanks(p);
    stop_at(p, "coordinate out of range: " + quote_word(p) + " (magnitude at most 1e30)");
  }
  return end;
}

/// Three numbers, each read by `read`.
template <const char* read(const char*, float&)>
const char* read_vector(const char* p, Vec3f& out) {
  Vec3f v;
  p = read(read(read(p, v.x), v.y), v.z);
  out = v;
  return skip_blanks(p);
}

const char* read_uv(const char* p, Vec2f& out) {
  Vec2f uv;
  p = skip_blanks(read_number(p, uv.x));
  if (!is_line_end(*p) && *p != '#') p = skip_blanks(read_number(p, uv.y));
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
