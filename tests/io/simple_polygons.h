#pragma once
/// \file Outlines on whole numbers that do not cross themselves by the way they are made, of any size.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace oktett::test {

struct GridPoint {
  std::int64_t x, y;
  bool operator==(const GridPoint&) const = default;
};
using Outline = std::vector<GridPoint>;

/// Twice the area of the triangle; exact up to 2^30.
inline std::int64_t doubled_area(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Twice the area of an outline, by the shoelace formula.
inline std::int64_t doubled_area(const Outline& p) {
  std::int64_t sum = 0;
  for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) sum += doubled_area(p[0], p[j], p[i]);
  return sum;
}

inline int whole(std::mt19937& random, int from, int to) {
  return from + static_cast<int>(random() % static_cast<unsigned>(to - from + 1));
}

inline GridPoint on_circle(double radius, double angle) {
  return {std::llround(radius * std::cos(angle)), std::llround(radius * std::sin(angle))};
}

/// Around the origin with random radii. A corner that rounding moves back is left out.
inline Outline star(int corners, std::mt19937& random) {
  Outline p;
  const GridPoint origin{0, 0};
  const int least = whole(random, 1, 90);
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.9 * whole(random, 0, 1000) / 1000) / corners;
    const GridPoint c = on_circle(whole(random, least, 100) * 10000.0, angle);
    if (p.empty() || (doubled_area(origin, p.back(), c) > 0 && (i < corners / 2 || c.y < 0))) p.push_back(c);
  }
  return p;
}

/// Two chains from left to right, one above zero and one below.
inline Outline chains(int corners, std::mt19937& random) {
  Outline p;
  const int height = whole(random, 1, 100000);
  for (int i = 0; i < corners / 2; ++i) p.push_back({i, -whole(random, 1, height)});
  for (int i = corners - corners / 2 - 1; i >= 0; --i) p.push_back({i, whole(random, 1, height)});
  return p;
}

/// A chain that leaves a straight line by its rounding alone, and one beside it.
inline Outline almost_straight(int corners, std::mt19937& random) {
  Outline p;
  const double slope = whole(random, -3000, 3000) / 1000.0;
  for (int i = 0; i < corners / 2; ++i) p.push_back({i, std::llround(slope * i)});
  for (int i = corners - corners / 2 - 1; i >= 0; --i) p.push_back({i, std::llround(slope * i) + 2});
  return p;
}

/// Teeth of random length, which may lean.
inline Outline comb(int corners, std::mt19937& random) {
  Outline p{{0, -1}, {3 * (corners / 3), -1}};
  const int lean = whole(random, -3, 3);
  for (int i = corners / 3; i-- > 0;) {
    const int height = whole(random, 1, 2000);
    p.insert(p.end(), {{3 * i + 2, 0}, {3 * i + 2 + lean * height, height}, {3 * i + 1, 0}});
  }
  return p;
}

/// A corridor that winds inwards.
inline Outline spiral(int corners, std::mt19937& random) {
  Outline p;
  const int half = std::max(corners / 2, 100);
  const double turns = std::min(whole(random, 10, 1000) / 10.0, half / 64.0), wide = 0.5 * 0.9 / turns;
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i < half; ++i) {
      const double s = static_cast<double>(side == 0 ? i : half - 1 - i) / half;
      p.push_back(
          on_circle(1000000 * (1 - 0.9 * s - side * std::min(wide, 0.05)), 2 * std::numbers::pi * turns * s));
    }
  return p;
}

/// Roofs of houses side by side, of few heights.
inline Outline skyline(int corners, std::mt19937& random) {
  Outline p{{0, 0}};
  const int houses = std::max(1, corners / 3);
  for (int i = 1; i <= houses; ++i) p.push_back({i, 0});
  for (int i = houses; i-- > 0;) {
    const int height = whole(random, 1, 4);
    const GridPoint right{i + 1, height};
    if (p.back() != right) p.push_back(right);
    p.push_back({i, height});
  }
  return p;
}

/// The line through 4^order cells of a square that Hilbert described in 1891.
inline Outline hilbert_line(int order) {
  Outline line;
  for (std::int64_t i = 0; i < std::int64_t{1} << 2 * order; ++i) {
    GridPoint p{0, 0};
    for (int k = 0; k < order; ++k) {
      const std::int64_t rx = 1 & i >> (2 * k + 1), ry = 1 & (i >> 2 * k ^ rx), size = std::int64_t{1} << k;
      if (ry == 0) {
        if (rx == 1) p = {size - 1 - p.x, size - 1 - p.y};
        std::swap(p.x, p.y);
      }
      p.x += size * rx, p.y += size * ry;
    }
    line.push_back(p);
  }
  return line;
}

/// A wall along that line, 2 wide, with corridors 2 wide between; 2 * 4^order corners.
inline Outline hilbert_wall(int order) {
  const Outline line = hilbert_line(order);
  const auto n = line.size();
  Outline right, left;
  for (std::size_t i = 0; i < n; ++i) {
    const GridPoint &before = line[i > 0 ? i - 1 : i], &at = line[i], &after = line[i + 1 < n ? i + 1 : i];
    GridPoint in{at.x - before.x, at.y - before.y}, out{after.x - at.x, after.y - at.y};
    if (i == 0) in = out;
    if (i + 1 == n) out = in;
    const GridPoint by = in == out ? GridPoint{in.y, -in.x} : GridPoint{in.y + out.y, -in.x - out.x};
    right.push_back({4 * at.x + by.x, 4 * at.y + by.y}), left.push_back({4 * at.x - by.x, 4 * at.y - by.y});
  }
  right.insert(right.end(), left.rbegin(), left.rend());
  return right;
}

/// The way around a random tree of cells, counter-clockwise. Branches are 2 * `half` wide and 4 apart: with 2
/// they touch each other along all their length.
inline Outline around_tree(int width, int height, int half, std::mt19937& random) {
  static constexpr int kX[4] = {1, 0, -1, 0}, kY[4] = {0, 1, 0, -1};
  std::vector<std::array<bool, 4>> open(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto number = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  };
  std::vector<std::pair<int, int>> path{{0, 0}};
  std::vector<char> seen(open.size());
  seen[0] = 1;
  while (!path.empty()) {
    const auto [x, y] = path.back();
    int ways[4], count = 0;
    for (int way = 0; way < 4; ++way) {
      const int u = x + kX[way], v = y + kY[way];
      if (u >= 0 && u < width && v >= 0 && v < height && !seen[number(u, v)]) ways[count++] = way;
    }
    if (count == 0) {
      path.pop_back();
      continue;
    }
    const int way = ways[random() % static_cast<unsigned>(count)], u = x + kX[way], v = y + kY[way];
    open[number(x, y)][static_cast<std::size_t>(way)] = true;
    open[number(u, v)][static_cast<std::size_t>((way + 2) % 4)] = true;
    seen[number(u, v)] = 1;
    path.emplace_back(u, v);
  }
  // At each cell the next way to the left of where one came from.
  const auto is_open = [&](int x, int y, int way) {
    return open[number(x, y)][static_cast<std::size_t>(way)];
  };
  Outline p;
  int x = 0, y = 0, way = 0;
  while (!is_open(x, y, way)) ++way;
  const int first = way;
  do {
    x += kX[way], y += kY[way];
    int next = (way + 3) % 4;
    const auto corner = [&](int before, int after) {
      p.push_back({4 * x + half * (kX[before] + kX[after]), 4 * y + half * (kY[before] + kY[after])});
    };
    corner((way + 2) % 4, next);
    while (!is_open(x, y, next)) {
      corner(next, (next + 1) % 4);
      next = (next + 1) % 4;
    }
    way = next;
  } while (x != 0 || y != 0 || way != first);
  return p;
}

inline Outline around_tree(int corners, int half, std::mt19937& random) {
  const int width = std::max(2, static_cast<int>(std::sqrt(corners / 2.0 * whole(random, 1, 4)))),
            height = std::max(2, corners / 2 / width);
  return around_tree(width, height, half, random);
}

/// A rectangle with rows of holes. Each is joined to the one before, the first to the left side, by a bridge
/// that is walked there and back.
inline Outline with_holes(int corners, std::mt19937& random) {
  const int columns = whole(random, 1, 1 + static_cast<int>(std::sqrt(corners / 6.0)));
  const int rows = std::max(1, corners / (6 * columns));
  Outline p{{0, 0}, {100 * columns + 50, 0}, {100 * columns + 50, 100 * rows}, {0, 100 * rows}};
  for (int row = rows; row-- > 0;) {
    Outline back;
    const GridPoint start{0, 100 * row + whole(random, 1, 99)};
    p.push_back(start), back.push_back(start);
    for (int column = 0; column < columns; ++column) {
      const int x = 100 * column + 20, y = 100 * row + 50;
      const GridPoint west{x + whole(random, 0, 30), y + whole(random, -20, 20)},
          east{x + whole(random, 60, 90), y + whole(random, -20, 20)};
      p.push_back(west);
      for (int k = whole(random, 1, 3), i = 0; i < k; ++i)
        p.push_back({x + 32 + 8 * i, y + whole(random, 21, 50 - (row + 1 == rows))});
      p.push_back(east);
      back.push_back(west);
      for (int k = whole(random, 0, 3), i = 0; i < k; ++i)
        back.push_back({x + 32 + 8 * i, y - whole(random, 21, 50 - (row == 0))});
      // The last hole has its eastern corner once, those before twice.
      if (column + 1 < columns) back.push_back(east);
    }
    p.insert(p.end(), back.rbegin(), back.rend());
  }
  return p;
}

/// Whether two edges have a point in common.
inline bool edges_meet(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
  const auto sign = [](std::int64_t x) { return x > 0 ? 1 : x < 0 ? -1 : 0; };
  if (std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x) ||
      std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y))
    return false;
  return sign(doubled_area(a, b, c)) * sign(doubled_area(a, b, d)) <= 0 &&
         sign(doubled_area(c, d, a)) * sign(doubled_area(c, d, b)) <= 0;
}

/// Random corners, turned round between two edges that meet until none do; at most sixty. Edges that cross
/// become shorter each time; where corners lie on edges that may never end, so others are taken then.
inline Outline untangled(int corners, std::mt19937& random) {
  while (true) {
    Outline p;
    for (int i = 0; i < std::min(corners, 60); ++i)
      p.push_back({whole(random, 0, 9999), whole(random, 0, 9999)});
    const std::size_t n = p.size();
    bool changed = true;
    for (int pass = 0; changed && pass < 1000; ++pass) {
      changed = false;
      for (std::size_t i = 0; i + 2 < n; ++i)
        for (std::size_t j = i + 2; j < n && (i > 0 || j + 1 < n); ++j)
          if (edges_meet(p[i], p[i + 1], p[j], p[j + 1 < n ? j + 1 : 0])) {
            std::reverse(p.begin() + static_cast<std::ptrdiff_t>(i + 1),
                         p.begin() + static_cast<std::ptrdiff_t>(j + 1));
            changed = true;
          }
    }
    if (!changed) return p;
  }
}

struct SimplePolygon {
  std::string name;
  Outline outline;
  bool touches;  ///< itself
};

/// One of all these, with about so many corners.
inline SimplePolygon simple_polygon(int kind, int corners, std::mt19937& random) {
  switch (kind) {
    case 0:
      return {"star", star(corners, random), false};
    case 1:
      return {"chains", chains(corners, random), false};
    case 2:
      return {"almost straight", almost_straight(corners, random), false};
    case 3:
      return {"comb", comb(corners, random), false};
    case 4:
      return {"spiral", spiral(corners, random), false};
    case 5:
      return {"skyline", skyline(corners, random), false};
    case 6: {
      int order = 1;
      while (2 << 2 * (order + 1) <= corners) ++order;
      return {"Hilbert's wall", hilbert_wall(order), false};
    }
    case 7:
      return {"tree", around_tree(corners, 1, random), false};
    case 8:
      return {"tree without corridors", around_tree(corners, 2, random), true};
    case 9:
      return {"with holes", with_holes(corners, random), true};
    default:
      return {"untangled", untangled(corners, random), false};
  }
}
inline constexpr int kSimplePolygonKinds = 11;

/// Repeats corners, adds some on edges, and walks there and back along edges.
inline void add_needless_corners(SimplePolygon& polygon, std::mt19937& random) {
  const Outline p = std::exchange(polygon.outline, {});
  for (std::size_t i = 0; i < p.size(); ++i) {
    const GridPoint &a = p[i], &b = p[i + 1 < p.size() ? i + 1 : 0];
    polygon.outline.push_back(a);
    const int what = whole(random, 0, 19);
    const std::int64_t steps = std::gcd(b.x - a.x, b.y - a.y);
    if (what < 2) polygon.outline.insert(polygon.outline.end(), static_cast<std::size_t>(what + 1), a);
    if (what < 2 || what == 5) polygon.touches = true;
    if (steps < 2) continue;
    const std::int64_t k = whole(random, 1, static_cast<int>(steps - 1));
    const GridPoint between{a.x + (b.x - a.x) / steps * k, a.y + (b.y - a.y) / steps * k};
    if (what == 3 || what == 4) polygon.outline.push_back(between);
    if (what == 5) polygon.outline.insert(polygon.outline.end(), {between, a});
  }
}

}  // namespace oktett::test
