#pragma once
/// \file Menger's sponge, walked from cell to cell.
///
/// Cells are boxes of a grid of 3^depth to the side with integer corners, so no depth lets planes drift. The
/// walk knows one number, the distance t that it has reached, and which planes the line has crossed by then:
/// those whose distance is not greater. That distance is one formula of the plane's number and grows with it,
/// so that neighbours agree on where one ends and the other begins, and planes that are met at once are
/// crossed at once: there is no crack between cells and no cell of no length.

#include <vector>

#include "kernels/fractals/fractal.h"
#include "kernels/fractals/menger_data.h"

namespace oktett {

struct MengerElement {
  int depth;
  double side;  ///< cells to the side, 3^depth
};

/// Parts are faces as in LineRange: 1 + 2 axis + side.
struct Menger : Fractal<Menger, MengerShape, MengerElement> {
  static constexpr int kMaxCrossings = 64;

  static void add(Pool& pool, const MengerShape& shape, const ExactPlace& place);
  static int find(const Element& element, const FractalQuery& query, FractalCrossing* out, int room);
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
};

}  // namespace oktett
