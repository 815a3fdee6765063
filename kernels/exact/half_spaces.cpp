#include "kernels/exact/half_spaces.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace oktett {

namespace {

using Corners = std::vector<Vec3d>;

/// What of a convex polygon is in n.p <= offset (Sutherland and Hodgman 1974).
void clip(Corners& polygon, const Vec3d& n, double offset, Corners& scratch) {
  scratch.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double f = dot(n, p) - offset, g = dot(n, q) - offset;
    if (f <= 0) scratch.push_back(p);
    if ((f < 0 && g > 0) || (f > 0 && g < 0)) scratch.push_back(p + (q - p) * (f / (f - g)));
  }
  std::swap(polygon, scratch);
}

/// Whether there is a direction in which no half-space ends: one that meets a face of the unit cube.
bool has_free_direction(std::span<const HalfSpace> planes) {
  Corners polygon, scratch;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    polygon.assign(4, {});
    for (int i = 0; i < 4; ++i) {
      polygon[i][axis] = face % 2 == 0 ? -1 : 1;
      polygon[i][u] = i == 1 || i == 2 ? 1 : -1;
      polygon[i][v] = i >= 2 ? 1 : -1;
    }
    for (const HalfSpace& h : planes) {
      clip(polygon, h.normal, 1e-9, scratch);
      if (polygon.empty()) break;
    }
    if (!polygon.empty()) return true;
  }
  return false;
}

/// Corners and faces, looked for within about `reach` of `center`; planes have unit normals.
void enumerate(std::span<const HalfSpace> planes, const Vec3d& center, double reach, ConvexSolid& solid) {
  solid.vertices.clear(), solid.faces.clear();
  Corners polygon, scratch;
  const double tolerance = 1e-13 * reach;
  for (std::uint32_t i = 0; i < planes.size(); ++i) {
    const Vec3d n = planes[i].normal;
    const Vec3d foot = n * (planes[i].offset - dot(n, center));
    Vec3d u, v;
    make_basis(n, u, v);
    u *= reach, v *= reach;
    polygon = {foot - u - v, foot + u - v, foot + u + v, foot - u + v};
    for (std::uint32_t j = 0; j < planes.size() && !polygon.empty(); ++j)
      if (j != i)
        clip(polygon, planes[j].normal, planes[j].offset - dot(planes[j].normal, center) + tolerance,
             scratch);
    if (polygon.empty()) continue;
    solid.faces.push_back(i);
    for (const Vec3d& p : polygon) solid.vertices.push_back(center + p);
  }
}

}  // namespace

ConvexSolid intersect(std::span<const HalfSpace> half_spaces) {
  std::vector<HalfSpace> planes(half_spaces.begin(), half_spaces.end());
  double farthest = 0;
  for (HalfSpace& h : planes) {
    const double l = length(h.normal);
    h.normal = h.normal / l, h.offset = h.offset / l;
    farthest = std::max(farthest, std::abs(h.offset));
  }
  ConvexSolid solid;
  solid.kind = ConvexSolid::Kind::unbounded;
  if (has_free_direction(planes)) return solid;
  solid.kind = ConvexSolid::Kind::empty;
  // Each pass finds where to look more closely.
  Vec3d center{0, 0, 0};
  double reach = 1e10 * farthest;
  for (int pass = 0; pass < 4 && reach > 0; ++pass) {
    enumerate(planes, center, reach, solid);
    if (solid.vertices.empty()) return solid;
    Vec3d lo = solid.vertices.front(), hi = lo;
    for (const Vec3d& p : solid.vertices) lo = min(lo, p), hi = max(hi, p);
    center = (lo + hi) * 0.5, reach = length(hi - lo);
  }
  Vec3d middle{0, 0, 0};
  for (const Vec3d& p : solid.vertices) middle += p / static_cast<double>(solid.vertices.size());
  for (const HalfSpace& h : planes)
    if (!(dot(h.normal, middle) < h.offset - 1e-12 * reach)) return solid;
  solid.kind = ConvexSolid::Kind::solid;
  return solid;
}

}  // namespace oktett
