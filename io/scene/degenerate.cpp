#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "io/scene/readers.h"

namespace oktett {
namespace {

struct Point2 {
  double x, y;
};

/// > 0 if a, b, c turn left.
double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

int sign(double v) { return v > 0 ? 1 : v < 0 ? -1 : 0; }

/// True if `p`, known to be in line with a and b, lies between them.
bool between(const Point2& a, const Point2& b, const Point2& p) {
  return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

bool segments_touch(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const int abc = sign(turn(a, b, c)), abd = sign(turn(a, b, d));
  const int cda = sign(turn(c, d, a)), cdb = sign(turn(c, d, b));
  if (abc != abd && cda != cdb && abc * abd <= 0 && cda * cdb <= 0 && (abc != 0 || abd != 0)) return true;
  return (abc == 0 && between(a, b, c)) || (abd == 0 && between(a, b, d)) || (cda == 0 && between(c, d, a)) ||
         (cdb == 0 && between(c, d, b));
}

/// True if edge b-c runs back over edge a-b.
bool folds_back(const Point2& a, const Point2& b, const Point2& c) {
  const double along = (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y);
  return turn(a, b, c) == 0 && along < 0;
}

using Ring = std::vector<Point2>;

/// Sweeps over the edges by their least x, so that only edges that overlap in x are compared.
bool is_simple(const std::vector<Ring>& rings) {
  struct Edge {
    const Ring* ring;
    std::size_t number;
    Point2 a, b;
    double lo() const { return std::min(a.x, b.x); }
    double hi() const { return std::max(a.x, b.x); }
    bool is_beside(const Edge& e) const {
      const std::size_t n = ring->size();
      return ring == e.ring && ((number + 1) % n == e.number || (e.number + 1) % n == number);
    }
  };
  std::vector<Edge> edges;
  for (const Ring& ring : rings) {
    const std::size_t n = ring.size();
    for (std::size_t i = 0; i < n; ++i) {
      if (folds_back(ring[i], ring[(i + 1) % n], ring[(i + 2) % n])) return false;
      edges.push_back({&ring, i, ring[i], ring[(i + 1) % n]});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.lo() < b.lo(); });
  for (std::size_t k = 0; k < edges.size(); ++k)
    for (std::size_t l = k + 1; l < edges.size() && edges[l].lo() <= edges[k].hi(); ++l) {
      const Edge &a = edges[k], &b = edges[l];
      if (!a.is_beside(b) && segments_touch(a.a, a.b, b.a, b.b)) return false;
    }
  return true;
}

}  // namespace

std::string why_degenerate(const PolygonShape& polygon) {
  const std::vector<Vec3d>& v = polygon.vertices;
  if (v.size() < 3) return "the polygon has no area";
  // Newell's normal, relative to the first vertex to keep the products small.
  Vec3d normal{0, 0, 0}, lo = v[0], hi = v[0];
  for (std::size_t i = 0; i < v.size(); ++i) {
    normal += cross(v[i] - v[0], v[(i + 1) % v.size()] - v[0]);
    lo = min(lo, v[i]), hi = max(hi, v[i]);
  }
  const double size = length(hi - lo);
  if (!(length(normal) > 1e-12 * size * size)) return "the polygon has no area";
  const Vec3d unit = normalize(normal);
  Vec3d centre{0, 0, 0};
  for (const Vec3d& p : v) centre += p / static_cast<double>(v.size());
  for (const Vec3d& p : v)
    if (std::abs(dot(unit, p - centre)) > 1e-5 * size) return "the polygon is not planar";
  const int axis = dominant_axis(unit);
  std::vector<Ring> rings;
  const auto add = [&](const std::vector<Vec3d>& ring) {
    Ring& points = rings.emplace_back();
    for (const Vec3d& p : ring) points.push_back({p[(axis + 1) % 3], p[(axis + 2) % 3]});
  };
  add(v);
  for (const auto& [hole] : polygon.holes) {
    if (hole.size() < 3) return "a hole of the polygon has no area";
    for (const Vec3d& p : hole)
      if (std::abs(dot(unit, p - centre)) > 1e-5 * size) return "a hole is not in the plane of the polygon";
    add(hole);
  }
  return is_simple(rings) ? "" : "the polygon is not simple: its edges touch each other";
}

std::string why_degenerate(const Affine& transform) {
  if (!transform.is_invertible()) return "the transform is singular";
  for (const auto& row : transform.m)
    for (const double value : row)
      if (!(std::abs(value) <= kMaxCoordinate)) return "the transform moves things out of range";
  return "";
}

void remove_repeated_vertices(PolygonShape& polygon) {
  const auto clean = [](std::vector<Vec3d>& v) {
    v.erase(std::unique(v.begin(), v.end()), v.end());
    while (v.size() > 1 && v.front() == v.back()) v.pop_back();
  };
  clean(polygon.vertices);
  for (PolygonHole& hole : polygon.holes) clean(hole.vertices);
}

}  // namespace oktett
