#include "core/mesh_geometry.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

namespace oktett {

namespace {

/// For each vertex, the lowest index of a vertex at the same position.
std::vector<std::uint32_t> weld(const TriangleMesh& mesh) {
  // Compared as bits, NaN has a place in the order. Adding zero turns -0 into 0.
  const auto key = [&](std::uint32_t i) {
    const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x + 0.0f); };
    const Vec3f& p = mesh.positions[i];
    return std::tuple(bits(p.x), bits(p.y), bits(p.z));
  };
  std::vector<std::uint32_t> order(mesh.positions.size()), first(order.size());
  std::iota(order.begin(), order.end(), 0u);
  tbb::parallel_sort(order.begin(), order.end(),
                     [&](auto a, auto b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  return first;
}

}  // namespace

OpenEdges find_open_edges(const TriangleMesh& mesh) {
  // The lower index first, so that both directions of an edge sort together.
  struct Edge {
    std::uint32_t low, high;
    std::size_t place;
    bool backwards;
    bool operator<(const Edge& b) const {
      return std::tie(low, high, place) < std::tie(b.low, b.high, b.place);
    }
  };
  const std::vector<std::uint32_t> vertex = weld(mesh);
  std::vector<Edge> edges;
  edges.reserve(mesh.triangle_count() * 3);
  for (std::size_t i = 0; i < mesh.triangle_count() * 3; ++i) {
    const std::uint32_t a = vertex[mesh.indices[i]], b = vertex[mesh.indices[i % 3 == 2 ? i - 2 : i + 1]];
    if (a != b) edges.push_back({std::min(a, b), std::max(a, b), i, a > b});
  }
  tbb::parallel_sort(edges.begin(), edges.end());
  OpenEdges open;
  std::size_t first = mesh.indices.size();
  for (std::size_t begin = 0, end; begin < edges.size(); begin = end) {
    std::int64_t balance = 0;
    for (end = begin;
         end < edges.size() && edges[begin].low == edges[end].low && edges[begin].high == edges[end].high;
         ++end)
      balance += edges[end].backwards ? -1 : 1;
    if (balance == 0) continue;
    ++open.count;
    if (edges[begin].place > first) continue;
    first = edges[begin].place;
    open.from = mesh.positions[edges[begin].low], open.to = mesh.positions[edges[begin].high];
  }
  return open;
}

}  // namespace oktett
