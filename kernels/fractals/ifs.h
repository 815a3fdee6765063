#pragma once
/// \file Iterated function systems (M. Barnsley: Fractals Everywhere, 1988), as the union of the images of a
/// ball or a box.
///
/// The ray is taken into the space of each piece in turn, in which the piece is the base itself and all that
/// becomes of it lies in one of a few balls: the ball of the base, and for each level that of the images of
/// the ball of the level below, found from the bottom up. So bounds are proved whatever the maps.

#include <vector>

#include "kernels/fractals/fractal.h"
#include "kernels/fractals/ifs_data.h"

namespace oktett {

struct IfsElement {
  struct Map {
    Affine to_piece, to_parent;
    double norm;  ///< an upper bound of the linear part's
    double back;  ///< the same of the inverse's
  };
  struct Ball {
    Vec3d center;
    double radius;
  };
  IfsShape::Base base;
  bool every_level;
  double least;
  std::vector<Map> maps;
  /// Holds all pieces below one that is still to be divided k times.
  std::vector<Ball> balls;
  double rounding;  ///< what one level may displace a line by, in units of the piece

  int depth() const { return static_cast<int>(balls.size()) - 1; }
};

struct Ifs : Fractal<Ifs, IfsShape, IfsElement> {
  static void add(Pool& pool, const IfsShape& shape, const ExactPlace& place);
  static int find(const Element& element, const FractalQuery& query, FractalCrossing* out, int room);
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  static Box world_bounds(const Pool& pool, std::size_t i);
  /// An upper bound of how much the map stretches any vector, at most 10^-6 of it too large.
  static double norm(const Affine& map);
};

}  // namespace oktett
