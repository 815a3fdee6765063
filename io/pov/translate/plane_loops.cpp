#include "io/pov/translate/plane_loops.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "core/vec3.h"
#include "io/mesh/polygon.h"

namespace oktett::pov {

double area(const Loop& loop) {
  double sum = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const PlainPoint &a = loop[i], &b = loop[(i + 1) % loop.size()];
    sum += a.x * b.y - b.x * a.y;
  }
  return sum / 2;
}

namespace {

double side(const PlainPoint& a, const PlainPoint& b, const PlainPoint& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool contains(const Loop& loop, const PlainPoint& p) {
  bool inside = false;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const PlainPoint &a = loop[i], &b = loop[(i + 1) % loop.size()];
    if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x) inside = !inside;
  }
  return inside;
}

/// Joins a hole to an outline by a bridge to the right of the hole's rightmost corner.
void bridge(Loop& outline, const Loop& hole, const std::vector<const Loop*>& holes) {
  std::size_t from = 0;
  for (std::size_t i = 1; i < hole.size(); ++i)
    if (hole[i].x > hole[from].x) from = i;
  const PlainPoint p = hole[from];
  // The corner of the outline that is seen from there, nearest first.
  std::vector<std::size_t> order(outline.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto distance = [&](std::size_t i) { return std::hypot(outline[i].x - p.x, outline[i].y - p.y); };
  std::ranges::stable_sort(order, {}, distance);
  const auto crosses = [&](const Loop& loop, const PlainPoint& q) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const PlainPoint &a = loop[i], &b = loop[(i + 1) % loop.size()];
      if (side(p, q, a) * side(p, q, b) < 0 && side(a, b, p) * side(a, b, q) < 0) return true;
    }
    return false;
  };
  std::size_t to = order[0];
  for (const std::size_t i : order)
    if (!crosses(outline, outline[i]) &&
        std::ranges::none_of(holes, [&](const Loop* other) { return crosses(*other, outline[i]); })) {
      to = i;
      break;
    }
  Loop joined(outline.begin(), outline.begin() + static_cast<std::ptrdiff_t>(to) + 1);
  for (std::size_t i = 0; i <= hole.size(); ++i) joined.push_back(hole[(from + i) % hole.size()]);
  joined.insert(joined.end(), outline.begin() + static_cast<std::ptrdiff_t>(to), outline.end());
  outline = std::move(joined);
}

/// Of loops that do not cross each other.
void fill_plain(std::vector<Loop> loops, const std::function<void(PlainPoint, PlainPoint, PlainPoint)>& add) {
  std::vector<int> depth(loops.size());
  for (std::size_t i = 0; i < loops.size(); ++i)
    for (std::size_t j = 0; j < loops.size(); ++j) depth[i] += i != j && contains(loops[j], loops[i][0]);
  for (std::size_t i = 0; i < loops.size(); ++i)
    if ((area(loops[i]) > 0) != (depth[i] % 2 == 0)) std::ranges::reverse(loops[i]);
  PolygonTriangulator triangulator;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (depth[i] % 2 != 0) continue;
    Loop outline = loops[i];
    std::vector<const Loop*> holes;
    for (std::size_t j = 0; j < loops.size(); ++j)
      if (depth[j] == depth[i] + 1 && contains(loops[i], loops[j][0])) holes.push_back(&loops[j]);
    const auto rightmost = [](const Loop* loop) {
      double x = -HUGE_VAL;
      for (const PlainPoint& p : *loop) x = std::max(x, p.x);
      return -x;
    };
    std::ranges::stable_sort(holes, {}, rightmost);
    for (const Loop* hole : holes) bridge(outline, *hole, holes);
    std::vector<Vec3f> points;
    for (const PlainPoint& p : outline) points.push_back(Vec3f(Vec3d{p.x, p.y, 0}));
    const auto triangles = triangulator.run(points);
    for (std::size_t k = 0; k + 2 < triangles.size(); k += 3)
      add(outline[triangles[k]], outline[triangles[k + 1]], outline[triangles[k + 2]]);
  }
}

/// Loops that cross each other. All their points are joined by horizontal lines, which cut the plane into
/// strips of trapezoids; loops get points where they pass these lines.
class EvenOdd {
 public:
  explicit EvenOdd(std::vector<Loop>& loops) : loops_(loops) {}

  /// Adds the points where loops cross. Returns whether there are any.
  bool cross_loops() {
    const Stops stops = crossings();
    if (std::ranges::all_of(stops, [](const auto& loop) { return loop.empty(); })) return false;
    insert(stops);
    return true;
  }

  void fill(const std::function<void(PlainPoint, PlainPoint, PlainPoint)>& add) {
    note_levels();
    insert(passes());
    note_levels();
    for (auto low = levels_.begin(); std::next(low) != levels_.end(); ++low)
      fill_strip(low->first, std::next(low)->first, add);
  }

 private:
  /// A point on an edge.
  struct Stop {
    std::size_t edge;
    double at;  ///< part of the way along it
    PlainPoint point;
  };
  using Stops = std::vector<std::vector<Stop>>;
  struct Edge {
    std::size_t loop, number;
    PlainPoint a, b;
  };

  void note_levels() {
    for (const Loop& loop : loops_)
      for (const PlainPoint& p : loop) levels_[p.y].insert(p.x);
  }

  std::vector<Edge> edges() const {
    std::vector<Edge> all;
    for (std::size_t l = 0; l < loops_.size(); ++l) {
      const Loop& p = loops_[l];
      for (std::size_t i = 0; i < p.size(); ++i) all.push_back({l, i, p[i], p[(i + 1) % p.size()]});
    }
    return all;
  }

  Stops crossings() const {
    Stops stops(loops_.size());
    const std::vector<Edge> all = edges();
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t j = i + 1; j < all.size(); ++j) {
        const Edge &e = all[i], &f = all[j];
        const double fa = side(e.a, e.b, f.a), fb = side(e.a, e.b, f.b);
        const double ea = side(f.a, f.b, e.a), eb = side(f.a, f.b, e.b);
        if (!(fa * fb < 0 && ea * eb < 0)) continue;
        const double t = ea / (ea - eb), u = fa / (fa - fb);
        const PlainPoint p{e.a.x + (e.b.x - e.a.x) * t, e.a.y + (e.b.y - e.a.y) * t};
        stops[e.loop].push_back({e.number, t, p}), stops[f.loop].push_back({f.number, u, p});
      }
    return stops;
  }

  /// Where edges pass the lines through points.
  Stops passes() const {
    Stops stops(loops_.size());
    for (const Edge& e : edges()) {
      if (e.a.y == e.b.y) continue;
      const auto end = levels_.lower_bound(std::max(e.a.y, e.b.y));
      for (auto level = levels_.upper_bound(std::min(e.a.y, e.b.y)); level != end; ++level) {
        const double t = (level->first - e.a.y) / (e.b.y - e.a.y);
        stops[e.loop].push_back({e.number, t, {e.a.x + (e.b.x - e.a.x) * t, level->first}});
      }
    }
    return stops;
  }

  void insert(Stops stops) {
    for (std::size_t l = 0; l < loops_.size(); ++l) {
      std::ranges::stable_sort(stops[l], {}, [](const Stop& s) { return std::pair(s.edge, s.at); });
      Loop out;
      auto stop = stops[l].begin();
      for (std::size_t i = 0; i < loops_[l].size(); ++i) {
        out.push_back(loops_[l][i]);
        for (; stop != stops[l].end() && stop->edge == i; ++stop) out.push_back(stop->point);
      }
      loops_[l] = std::move(out);
    }
  }

  void fill_strip(double low, double high,
                  const std::function<void(PlainPoint, PlainPoint, PlainPoint)>& add) const {
    std::vector<std::pair<double, double>> sides;  // x at both lines
    for (const Edge& e : edges()) {
      if (e.a.y == low && e.b.y == high) sides.emplace_back(e.a.x, e.b.x);
      if (e.b.y == low && e.a.y == high) sides.emplace_back(e.b.x, e.a.x);
    }
    std::ranges::sort(sides, {}, [](const auto& s) { return s.first + s.second; });
    for (std::size_t i = 0; i + 1 < sides.size(); i += 2) {
      const std::vector<double> bottom = between(low, sides[i].first, sides[i + 1].first);
      const std::vector<double> top = between(high, sides[i].second, sides[i + 1].second);
      for (std::size_t b = 0, t = 0; b + 1 < bottom.size() || t + 1 < top.size();) {
        const bool along_bottom = t + 1 >= top.size() ||
                                  (b + 1 < bottom.size() && bottom[b + 1] - bottom[0] <= top[t + 1] - top[0]);
        if (along_bottom)
          add({bottom[b], low}, {bottom[b + 1], low}, {top[t], high}), ++b;
        else
          add({bottom[b], low}, {top[t + 1], high}, {top[t], high}), ++t;
      }
    }
  }

  /// The points of a line from `from` to `to`.
  std::vector<double> between(double level, double from, double to) const {
    const std::set<double>& all = levels_.at(level);
    std::vector<double> out(all.lower_bound(from), all.upper_bound(to));
    if (out.empty()) out = {from, to};
    return out;
  }

  std::vector<Loop>& loops_;
  std::map<double, std::set<double>> levels_;
};

}  // namespace

void fill(std::vector<Loop> loops, const std::function<void(PlainPoint, PlainPoint, PlainPoint)>& add) {
  EvenOdd even_odd(loops);
  if (even_odd.cross_loops()) return even_odd.fill(add);
  fill_plain(std::move(loops), add);
}

}  // namespace oktett::pov
