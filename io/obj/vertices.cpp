#include "io/obj/vertices.h"

#include <cmath>

#include "io/obj/statement.h"
#include "io/text/number.h"

namespace oktett {
namespace {

class VertexReader {
 public:
  VertexReader(const ObjChunk& chunk, TriangleMesh& mesh)
      : chunk_(chunk), mesh_(mesh), next_(chunk.before), last_(chunk.before) {
    last_ += chunk.counts;
  }

  void run() {
    for (const char* p = chunk_.begin; p < chunk_.end;) {
      p = skip_blanks(p);
      const char* rest = p;
      if (p[0] == 'v') {
        if (is_delimiter(p + 1))
          rest = read_position(p + 1);
        else if (p[1] == 'n' && is_delimiter(p + 2))
          rest = read_normal(p + 2);
        else if (p[1] == 't' && is_delimiter(p + 2))
          rest = read_uv(p + 2);
      }
      p = next_line(is_line_end(*rest) ? rest : find_joined_line_end(rest), chunk_.end);
    }
  }

 private:
  const char* read_position(const char* p) {
    if (next_.positions == last_.positions) stop_changed(p);
    Vec3f v;
    p = read_coordinate(p, v.x);
    p = read_coordinate(p, v.y);
    p = read_coordinate(p, v.z);
    mesh_.positions[next_.positions++] = v;
    return skip_blanks(p);
  }

  const char* read_normal(const char* p) {
    if (next_.normals == last_.normals) stop_changed(p);
    Vec3f n;
    p = read_number(p, n.x);
    p = read_number(p, n.y);
    p = read_number(p, n.z);
    mesh_.normals[next_.normals++] = n;
    return skip_blanks(p);
  }

  const char* read_uv(const char* p) {
    if (next_.uvs == last_.uvs) stop_changed(p);
    Vec2f uv;
    p = skip_blanks(read_number(p, uv.x));
    if (!is_line_end(*p) && *p != '#') p = skip_blanks(read_number(p, uv.y));
    mesh_.uvs[next_.uvs++] = uv;
    return p;
  }

  static const char* read_number(const char* p, float& x) {
    p = skip_blanks(p);
    NumberProblem problem = NumberProblem::none;
    const char* end = scan_float(p, x, problem);
    if (end == nullptr) stop_at_number(p, problem);
    return end;
  }

  static const char* read_coordinate(const char* p, float& x) {
    const char* end = read_number(p, x);
    if (!std::isfinite(x)) {
      p = skip_blanks(p);
      stop_at(p, "expected a finite number, found " + quote_word(p));
    }
    return end;
  }

  [[noreturn]] static void stop_at_number(const char* p, NumberProblem problem) {
    if (is_line_end(*p) || *p == '#') stop_at(p, "expected a number, found the end of the line");
    if (problem == NumberProblem::overflow)
      stop_at(p, "expected a finite number, but " + quote_word(p) + " is out of range");
    stop_at(p, "expected a number, found " + quote_word(p));
  }

  const ObjChunk& chunk_;
  TriangleMesh& mesh_;
  ObjCounts next_;
  ObjCounts last_;
};

}  // namespace

void read_vertices(ObjChunk& chunk, TriangleMesh& mesh) {
  try {
    VertexReader(chunk, mesh).run();
  } catch (const ObjStop& stop) {
    keep_first(chunk.failure, stop.failure);
  }
}

}  // namespace oktett
