#pragma once
/// \file Strokes: the points and lines of mesh files. Within io/ only.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/box.h"
#include "core/mesh.h"

namespace oktett {

/// The mesh of strokes that each join two vertices of `mesh`, `ends`, which are the same for a point; see
/// MeshFile::strokes. It holds only the vertices that they need, in their order, and what these carry.
/// `slots`: of the material of each stroke, or empty.
TriangleMesh make_strokes(const TriangleMesh& mesh, const Column<std::uint32_t>& ends,
                          Column<std::uint16_t> slots);

/// The strokes of a slot, as a mesh without slots.
struct StrokeSlot {
  TriangleMesh strokes;
  std::uint16_t slot = 0;
};
/// Those of each slot for itself, in the order of the first of them.
std::vector<StrokeSlot> split_by_slot(TriangleMesh strokes);

/// How wide so many strokes are shown in a box of what there is to be seen, if nothing is said: 1/200 of its
/// diagonal, or of more than 40 000 strokes the diagonal by the square root of their number, so that points
/// all over a surface leave few gaps and do not hide each other.
double usual_stroke_width(const Box& box, std::size_t strokes);

struct StrokeCount {
  std::size_t points = 0, lines = 0;

  void add(const TriangleMesh& strokes);
  std::size_t all() const { return points + lines; }
  /// "3 points and 1 line".
  std::string text() const;
  /// What is said of strokes whose width the user has left open.
  std::string width_message(double width) const;
};

}  // namespace oktett
