#include "io/mesh/contour/links.h"

#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace oktett {
namespace {

/// A crossing on the way around a face.
struct FacePoint {
  SlotNumber slot;
  int turn;       ///< as seen on the way
  double x, y;    ///< place in the face
  double nx, ny;  ///< normal in the face
};

/// Of a crossing that stays alone; a link costs at most 2.
constexpr double kAlone = 0.7;

/// What a link costs: the sines of the angles between it and the surface at its ends.
double cost(const FacePoint& p, const FacePoint& q) {
  const double dx = q.x - p.x, dy = q.y - p.y, size = std::hypot(dx, dy);
  if (!(size > 0)) return 2;
  return (std::abs(p.nx * dx + p.ny * dy) + std::abs(q.nx * dx + q.ny * dy)) / size;
}

class FaceLinks {
 public:
  FaceLinks(const ContourGrid& grid, const ContourCrossings& crossings, bool closed,
            std::vector<SlotNumber>& links)
      : grid_(grid), crossings_(crossings), closed_(closed), links_(links) {}

  /// The face at `p` with a normal along `axis`, if crossing `x` is the first on the way around it.
  void run(int axis, const GridPlace& p, std::uint32_t x) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    points_.clear();
    const std::array<Edge, 4> edges{Edge{b, p, 2, false}, Edge{c, moved(p, b, 1), 1, false},
                                    Edge{b, moved(p, c, 1), 3, true}, Edge{c, p, 0, true}};
    for (const Edge& edge : edges) {
      const CrossingRange range = crossings_.on_edge(grid_, edge.axis, edge.place);
      if (points_.empty() && !range.empty() && range.first != x) return;
      for (std::uint32_t k = 0; k < range.last - range.first; ++k)
        add(edge, edge.backwards ? range.last - 1 - k : range.first + k, b, c);
    }
    if (points_.size() == 2 && closed_)
      join(0, 1);
    else if (points_.size() > 1)
      match();
  }

 private:
  struct Edge {
    int axis;
    GridPlace place;
    std::uint32_t slot;
    bool backwards;
  };

  void add(const Edge& edge, std::uint32_t x, int b, int c) {
    const ContourCrossing& crossing = crossings_.all[x];
    const Vec3d at = crossings_.position(grid_, x);
    points_.push_back({kSlots * x + edge.slot, edge.backwards ? -crossing.turn : crossing.turn, at[b], at[c],
                       static_cast<double>(crossing.normal[b]), static_cast<double>(crossing.normal[c])});
  }

  void join(std::size_t i, std::size_t j) {
    links_[points_[i].slot] = points_[j].slot, links_[points_[j].slot] = points_[i].slot;
  }

  /// The cheapest links that do not cross, by dynamic programming: best_[i n + j] is for points i up to j.
  void match() {
    const std::size_t n = points_.size();
    best_.assign((n + 1) * (n + 1), 0), with_.assign((n + 1) * (n + 1), 0);
    const auto at = [n](std::size_t i, std::size_t j) { return i * (n + 1) + j; };
    for (std::size_t size = 1; size <= n; ++size)
      for (std::size_t i = 0; i + size <= n; ++i) {
        const std::size_t j = i + size;
        double best = (closed_ ? kNever : kAlone) + best_[at(i + 1, j)];
        std::size_t with = i;
        for (std::size_t k = i + 1; k < j; ++k) {
          if (points_[i].turn == points_[k].turn || (closed_ && (k - i) % 2 == 0)) continue;
          const double sum = cost(points_[i], points_[k]) + best_[at(i + 1, k)] + best_[at(k + 1, j)];
          if (sum < best) best = sum, with = k;
        }
        best_[at(i, j)] = best, with_[at(i, j)] = with;
      }
    waiting_.assign(1, {0, n});
    while (!waiting_.empty()) {
      const auto [i, j] = waiting_.back();
      waiting_.pop_back();
      if (i >= j) continue;
      const std::size_t k = with_[at(i, j)];
      if (k == i) {
        waiting_.emplace_back(i + 1, j);
        continue;
      }
      join(i, k);
      waiting_.emplace_back(i + 1, k), waiting_.emplace_back(k + 1, j);
    }
  }

  static constexpr double kNever = 1e6;
  const ContourGrid& grid_;
  const ContourCrossings& crossings_;
  const bool closed_;
  std::vector<SlotNumber>& links_;
  std::vector<FacePoint> points_;
  std::vector<double> best_;
  std::vector<std::size_t> with_;
  std::vector<std::pair<std::size_t, std::size_t>> waiting_;
};

}  // namespace

std::vector<SlotNumber> link_crossings(const ContourGrid& grid, const ContourCrossings& crossings,
                                       bool closed) {
  std::vector<SlotNumber> links(kSlots * crossings.all.size(), kNoId);
  in_parts(crossings.all.size(), 4096, [&](std::size_t begin, std::size_t end) {
    FaceLinks faces(grid, crossings, closed, links);
    for (std::size_t i = begin; i < end; ++i) {
      const auto x = static_cast<std::uint32_t>(i);
      const ContourCrossing& crossing = crossings.all[x];
      const int b = (crossing.axis + 1) % 3, c = (crossing.axis + 2) % 3;
      faces.run(b, crossing.place, x), faces.run(b, moved(crossing.place, c, -1), x);
      faces.run(c, crossing.place, x), faces.run(c, moved(crossing.place, b, -1), x);
    }
  });
  return links;
}

}  // namespace oktett
