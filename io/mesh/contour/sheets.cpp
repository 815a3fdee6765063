#include "io/mesh/contour/sheets.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "io/mesh/contour/qef.h"

namespace oktett {

// ---- Which crossings are on one sheet.

namespace {

/// Sets of numbers that are joined (Tarjan 1975).
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t i, std::uint32_t j) {
    i = find(i), j = find(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace

ContourSheets find_sheets(const ContourCrossings& crossings, const std::vector<SlotNumber>& links) {
  Sets sets(kSlots * crossings.all.size());
  for (std::uint32_t slot = 0; slot < links.size(); ++slot)
    if (links[slot] != kNoId && slot < links[slot])
      for (const std::uint32_t side : {0u, 1u})
        sets.join(quadrant_at(slot, side), quadrant_at(links[slot], side));
  ContourSheets sheets;
  sheets.of_quadrant.resize(links.size());
  std::vector<std::uint32_t> sizes;
  for (std::uint32_t i = 0; i < links.size(); ++i) {
    const std::uint32_t root = sets.find(i);
    if (root == i) {
      sheets.of_quadrant[i] = static_cast<std::uint32_t>(sizes.size());
      sizes.push_back(0);
    }
    sheets.of_quadrant[i] = sheets.of_quadrant[root];
    ++sizes[sheets.of_quadrant[i]];
  }
  sheets.begin.assign(sizes.size() + 1, 0);
  std::partial_sum(sizes.begin(), sizes.end(), sheets.begin.begin() + 1);
  sheets.quadrants.resize(links.size());
  std::vector<std::uint32_t> next(sheets.begin.begin(), sheets.begin.end() - 1);
  for (std::uint32_t i = 0; i < links.size(); ++i) sheets.quadrants[next[sheets.of_quadrant[i]]++] = i;
  return sheets;
}

// ---- Where their vertices are.

namespace {

/// Normals that differ by less belong to one smooth part of the surface, as a cosine.
constexpr double kSmooth = 0.9;
/// A third normal stands out of the plane of two others by more than this sine.
constexpr double kCorner = 0.3;
/// Rays for a part of an edge or corner begin so much nearer to its crossings, so that they meet it.
constexpr double kAside = 0.1;
/// How often vertices are moved.
constexpr int kRounds = 3;
/// Vertices that a task takes.
constexpr std::size_t kVerticesOfTask = 1024;

/// The part of the surface of a sheet that is smooth.
struct SmoothPart {
  Vec3d middle, normal;  ///< of its crossings
  Vec3d point;           ///< on it, next to the vertex
};

struct MovingVertex {
  Vec3d position, lo, hi;  ///< and its cell
  SmoothPart parts[3];
  int count = 0;
  bool done = false;
};

bool holds(const Vec3d& lo, const Vec3d& hi, double margin, const Vec3d& p) {
  for (int k = 0; k < 3; ++k)
    if (!(p[k] >= lo[k] - margin && p[k] <= hi[k] + margin)) return false;
  return true;
}

/// The greatest rank whose minimum lies in the cell; else the minimum of rank 1 moved into it.
Vec3d minimum_in(const PlaneError& error, const Vec3d& start, const Vec3d& lo, const Vec3d& hi,
                 double margin) {
  Vec3d p = start;
  for (int rank = 3; rank > 0; --rank) {
    p = error.minimum(start, rank);
    if (holds(lo, hi, margin, p)) return p;
  }
  return max(lo, min(hi, p));
}

class Placing {
 public:
  Placing(const Accel& accel, const ContourGrid& grid, const ContourCrossings& crossings,
          const ContourSheets& sheets, const std::vector<SlotNumber>& links,
          const std::vector<RimPoint>& rims)
      : accel_(accel), grid_(grid), crossings_(crossings), sheets_(sheets), links_(links), rims_(rims) {}

  void run(std::size_t begin, std::size_t end, SheetVertex* out) {
    std::vector<MovingVertex> vertices;
    for (std::size_t sheet = begin; sheet < end; ++sheet) vertices.push_back(first(sheet));
    for (int round = 0; round < kRounds; ++round) move(vertices);
    for (const MovingVertex& v : vertices) {
      SheetVertex& vertex = *out++;
      vertex.position = v.position;
      vertex.smooth_parts = static_cast<std::uint8_t>(v.count);
      for (int k = 0; k < v.count; ++k) vertex.normals[k] = Vec3f(v.parts[k].normal);
    }
  }

 private:
  /// A place on the sheet.
  struct Point {
    Vec3d position, normal;
  };

  /// Crossings, and points of rims.
  void gather(std::size_t sheet) {
    points_.clear();
    for (std::uint32_t i = sheets_.begin[sheet]; i < sheets_.begin[sheet + 1]; ++i) {
      const std::uint32_t quadrant = sheets_.quadrants[i], x = quadrant / kSlots;
      points_.push_back({crossings_.position(grid_, x), Vec3d(crossings_.all[x].normal)});
      if (rims_.empty()) continue;
      const auto [first, second] = slots_of(quadrant);
      for (const SlotNumber slot : {first, second})
        if (const RimPoint* const rim = find_rim(rims_, std::min(slot, links_[slot])))
          points_.push_back({rim->position, Vec3d(rim->normal)});
    }
  }

  MovingVertex first(std::size_t sheet) {
    gather(sheet);
    MovingVertex v;
    PlaneError error;
    Vec3d sum;
    for (const Point& p : points_) error.add(p.position, p.normal), sum += p.position;
    const Vec3d mean = sum / static_cast<double>(points_.size());
    const std::uint32_t quadrant = sheets_.quadrants[sheets_.begin[sheet]];
    const ContourCrossing& crossing = crossings_.all[quadrant / kSlots];
    GridPlace cell = crossing.place;
    if ((quadrant & 2) != 0) cell = moved(cell, (crossing.axis + 1) % 3, -1);
    if ((quadrant & 1) != 0) cell = moved(cell, (crossing.axis + 2) % 3, -1);
    v.lo = grid_.corner(cell), v.hi = grid_.corner({cell[0] + 1, cell[1] + 1, cell[2] + 1});
    v.position = minimum_in(error, mean, v.lo, v.hi, 0);
    find_parts(v);
    return v;
  }

  /// Divides the points of a sheet by their normals.
  void find_parts(MovingVertex& v) const {
    Vec3d seeds[3] = {points_.front().normal};
    v.count = 1;
    double least = kSmooth;
    for (const Point& p : points_)
      if (const double d = dot(p.normal, seeds[0]); d < least) least = d, seeds[1] = p.normal, v.count = 2;
    if (v.count == 2) {
      const Vec3d across = cross(seeds[0], seeds[1]);
      // The two sides of a plate; a third part is what is least along them.
      const bool opposite = length(across) < 0.1;
      double most = opposite ? 0.5 : kCorner * length(across);
      for (const Point& p : points_) {
        const double d = opposite ? length(cross(p.normal, seeds[0])) : std::abs(dot(p.normal, across));
        if (d > most) most = d, seeds[2] = p.normal, v.count = 3;
      }
    }
    Vec3d middles[3], normals[3];
    int sizes[3] = {};
    for (const Point& p : points_) {
      int best = 0;
      for (int k = 1; k < v.count; ++k)
        if (dot(p.normal, seeds[k]) > dot(p.normal, seeds[best])) best = k;
      middles[best] += p.position, normals[best] += p.normal, ++sizes[best];
    }
    for (int k = 0; k < v.count; ++k) {
      v.parts[k].middle = v.parts[k].point = middles[k] / static_cast<double>(sizes[k]);
      const double size = length(normals[k]);
      v.parts[k].normal = size > 0 ? normals[k] / size : seeds[k];
    }
  }

  void move(std::vector<MovingVertex>& vertices) const {
    struct Asked {
      std::size_t vertex;
      int part;
      double best;
    };
    const double reach = 0.5 * grid_.spacing;
    RayBatch rays;
    std::vector<Asked> asked;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const MovingVertex& v = vertices[i];
      for (int k = 0; k < v.count && !v.done; ++k) {
        const SmoothPart& part = v.parts[k];
        const Vec3d at = v.count == 1 ? v.position : v.position + (part.middle - v.position) * kAside;
        rays.push_back(
            {Vec3f(at + part.normal * reach), 0, Vec3f(-part.normal), static_cast<float>(2 * reach)});
        asked.push_back({i, k, reach});
      }
    }
    std::vector<std::uint8_t> met(vertices.size(), 0);
    std::vector<SmoothPart> found(asked.size());
    for (const ContourSample& sample : sample_rays(accel_, rays)) {
      Asked& ray = asked[sample.ray];
      const MovingVertex& v = vertices[ray.vertex];
      const Vec3d normal(sample.normal);
      const double off = std::abs(sample.t - reach), facing = dot(normal, v.parts[ray.part].normal);
      if (!(off < ray.best) || std::abs(facing) < 0.5) continue;
      ray.best = off, met[ray.vertex] |= static_cast<std::uint8_t>(1 << ray.part);
      found[sample.ray].point = sample.position, found[sample.ray].normal = facing < 0 ? -normal : normal;
    }
    for (std::size_t i = 0; i < asked.size(); ++i) {
      if ((met[asked[i].vertex] >> asked[i].part & 1) == 0) continue;
      SmoothPart& part = vertices[asked[i].vertex].parts[asked[i].part];
      part.point = found[i].point, part.normal = found[i].normal;
    }
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (!vertices[i].done) settle(vertices[i], met[i]);
  }

  void settle(MovingVertex& v, std::uint8_t met) const {
    if (v.count == 1) {
      // Where there is nothing, at the rim of an open surface, the vertex stays.
      if (met == 0 || length(v.parts[0].point - v.position) < 1e-6 * grid_.spacing) v.done = true;
      if (met != 0) v.position = v.parts[0].point;
      return;
    }
    double least = 1;
    for (int k = 1; k < v.count; ++k) least = std::min(least, dot(v.parts[0].normal, v.parts[k].normal));
    if (least > kSmooth && met != 0) {
      // It was no edge, but much curved.
      int first = 0;
      while ((met >> first & 1) == 0) ++first;
      v.parts[0] = v.parts[first], v.count = 1;
      return;
    }
    PlaneError error;
    for (int k = 0; k < v.count; ++k) error.add(v.parts[k].point, v.parts[k].normal);
    const Vec3d p = error.minimum(v.position);
    if (holds(v.lo, v.hi, 0.1 * grid_.spacing, p)) v.position = p;
  }

  const Accel& accel_;
  const ContourGrid& grid_;
  const ContourCrossings& crossings_;
  const ContourSheets& sheets_;
  const std::vector<SlotNumber>& links_;
  const std::vector<RimPoint>& rims_;
  std::vector<Point> points_;  ///< of the sheet at hand
};

}  // namespace

std::vector<SheetVertex> place_vertices(const Accel& accel, const ContourGrid& grid,
                                        const ContourCrossings& crossings, const ContourSheets& sheets,
                                        const std::vector<SlotNumber>& links,
                                        const std::vector<RimPoint>& rims) {
  std::vector<SheetVertex> vertices(sheets.count());
  Chunks(vertices.size(), kVerticesOfTask).each(true, [&](std::size_t, std::size_t begin, std::size_t end) {
    Placing(accel, grid, crossings, sheets, links, rims).run(begin, end, vertices.data() + begin);
  });
  return vertices;
}

}  // namespace oktett
