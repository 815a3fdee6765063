#include "render/look/up_direction.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/box.h"
#include "core/mesh_geometry.h"

namespace oktett {
namespace {

/// The convex hull of points in a plane, from the lowest and the highest of them in each of some columns.
class PlaneHull {
 public:
  /// For points whose first coordinate lies between `low` and `low + width`, which is greater than zero.
  PlaneHull(double low, double width) : low_(low), scale_(kColumns / width), columns_(kColumns) {}

  void add(double x, double y) {
    Column& column = columns_[static_cast<std::size_t>(std::clamp((x - low_) * scale_, 0.0, kColumns - 1.0))];
    if (column.empty || y < column.lowest.second) column.lowest = {x, y};
    if (column.empty || y > column.highest.second) column.highest = {x, y};
    column.empty = false;
  }

  double area() const {
    std::vector<Point> points;
    for (const Column& column : columns_)
      if (!column.empty) points.insert(points.end(), {column.lowest, column.highest});
    std::sort(points.begin(), points.end());
    const double lower = chain_area(points);
    std::reverse(points.begin(), points.end());
    return (lower + chain_area(points)) / 2;
  }

 private:
  using Point = std::pair<double, double>;
  struct Column {
    Point lowest, highest;
    bool empty = true;
  };
  static constexpr int kColumns = 64;

  /// Twice the area of a triangle, negative if its corners run clockwise.
  static double turn(const Point& a, const Point& b, const Point& c) {
    return (b.first - a.first) * (c.second - a.second) - (b.second - a.second) * (c.first - a.first);
  }

  /// Twice the area between the chain of points that turns only to the left and the line between its ends.
  static double chain_area(const std::vector<Point>& points) {
    std::vector<Point> chain;
    for (const Point& p : points) {
      while (chain.size() > 1 && turn(chain[chain.size() - 2], chain.back(), p) <= 0) chain.pop_back();
      chain.push_back(p);
    }
    double sum = 0;
    for (std::size_t i = 2; i < chain.size(); ++i) sum += turn(chain[0], chain[i - 1], chain[i]);
    return sum;
  }

  double low_, scale_;
  std::vector<Column> columns_;
};

/// The part of the rectangle that the mesh fills along `axis` that its lowest hundredth spans.
double support(const TriangleMesh& mesh, const Vec3d& low, const Vec3d& extent, int axis) {
  const int across = axis == 0 ? 1 : 0, along = 3 - axis - across;
  const double rectangle = extent[across] * extent[along];
  if (!(rectangle > 0)) return 0;
  const double top = low[axis] + 0.01 * extent[axis];
  PlaneHull hull(low[across], extent[across]);
  for (const std::uint32_t index : mesh.indices) {
    const Vec3f& p = mesh.positions[index];
    if (p[axis] <= top) hull.add(p[across], p[along]);
  }
  return hull.area() / rectangle;
}

/// How triangles face, by area.
struct MeshFacing {
  double all = 0;
  Vec3d sum;       ///< of the normals; zero for a closed mesh
  Vec3d absolute;  ///< of their components without signs

  /// Whether the mesh is open and faces along `axis` almost everywhere: one side, and mostly.
  bool is_sheet(int axis) const {
    return absolute[axis] > 0.7 * all && std::abs(sum[axis]) > 0.9 * absolute[axis];
  }
};

MeshFacing facing_of(const TriangleMesh& mesh) {
  MeshFacing facing;
  // A sample of a hundred thousand triangles is enough.
  const std::size_t stride = 1 + mesh.triangle_count() / 100000;
  for (std::size_t i = 0; i < mesh.triangle_count(); i += stride) {
    const Vec3d n = area_normal(mesh, i);
    facing.all += length(n);
    facing.sum += n;
    facing.absolute += abs(n);
  }
  return facing;
}

}  // namespace

Vec3d guess_up(const TriangleMesh& mesh) {
  const Vec3d y{0, 1, 0}, z{0, 0, 1};
  Box box;
  for (const std::uint32_t index : mesh.indices) box.grow(mesh.positions[index]);
  if (box.empty()) return y;
  const Vec3d low(box.lo), extent = Vec3d(box.hi) - low;
  // Flat along z: a picture, a text, a drawing.
  const double width = std::min(extent.x, extent.y);
  if (!(extent.z > 1e-3 * width)) return y;
  const MeshFacing facing = facing_of(mesh);
  if (facing.is_sheet(1)) return y;
  if (facing.is_sheet(2)) return extent.z < width / 3 ? z : y;
  const double along_z = support(mesh, low, extent, 2);
  return along_z > 0.1 && along_z > 3 * support(mesh, low, extent, 1) ? z : y;
}

}  // namespace oktett
