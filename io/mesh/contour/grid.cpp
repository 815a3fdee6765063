#include "io/mesh/contour/grid.h"

#include <cmath>
#include <span>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"

namespace oktett {

ContourGrid ContourGrid::around(const Vec3d& lo, const Vec3d& hi, std::uint32_t cells) {
  ContourGrid grid;
  const Vec3d extent = hi - lo;
  grid.spacing = max_component(extent) / static_cast<double>(cells);
  // No simple fractions, and different along each axis.
  constexpr double kMargins[] = {1.4142, 1.3819, 1.5437};
  for (int axis = 0; axis < 3; ++axis) {
    const double start = lo[axis] - kMargins[axis] * grid.spacing;
    const auto count = static_cast<std::size_t>(std::ceil(extent[axis] / grid.spacing + kMargins[axis])) + 2;
    std::vector<float>& nodes = grid.nodes[static_cast<std::size_t>(axis)];
    for (std::size_t i = 0; i < count; ++i)
      nodes.push_back(static_cast<float>(start + static_cast<double>(i) * grid.spacing));
  }
  return grid;
}

std::vector<ContourSample> sample_rays(const Accel& accel, const RayBatch& rays) {
  HitLists lists;
  all_hits(accel, rays, lists);
  std::vector<ContourSample> samples;
  samples.reserve(lists.hits.size());
  RayBatch block_rays;
  HitBatch block_hits;
  block_rays.resize_uninitialized(InteractionBlock::kMost);
  block_hits.resize_uninitialized(InteractionBlock::kMost);
  std::uint32_t numbers[InteractionBlock::kMost];
  for (std::uint32_t k = 0; k < InteractionBlock::kMost; ++k) numbers[k] = k;
  std::size_t waiting = 0;
  const auto flush = [&] {
    InteractionBlock block;
    surface_interactions(accel, block_rays, block_hits, std::span(numbers, waiting), block);
    for (std::size_t k = 0; k < waiting; ++k) {
      ContourSample& sample = samples[samples.size() - waiting + k];
      sample.normal = InteractionBlock::get(block.geometric_normal, k);
      sample.user = block.user[k];
    }
    waiting = 0;
  };
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray ray = rays[i];
    for (const Hit& hit : lists.of_ray(i)) {
      const double t = static_cast<double>(hit.t);
      ContourSample sample;
      sample.position = Vec3d(ray.origin) + Vec3d(ray.direction) * t;
      sample.ray = static_cast<std::uint32_t>(i), sample.t = t;
      samples.push_back(sample);
      block_rays.set(waiting, ray), block_hits.span().set(waiting, hit);
      if (++waiting == InteractionBlock::kMost) flush();
    }
  }
  if (waiting > 0) flush();
  std::erase_if(samples, [](const ContourSample& s) { return !is_finite(s.normal); });
  return samples;
}

namespace {

/// Lines that a task takes.
constexpr std::size_t kLinesOfTask = 1024;

struct LineChunk {
  std::vector<ContourCrossing> crossings;
  std::vector<std::uint32_t> counts;  ///< of each line
};

LineChunk sample_lines(const Accel& accel, const ContourGrid& grid, int axis, std::size_t begin,
                       std::size_t end) {
  const auto k = static_cast<std::size_t>(axis);
  const std::vector<float>& nodes = grid.nodes[k];
  Vec3f direction;
  direction[axis] = 1;
  RayBatch rays;
  for (std::size_t line = begin; line < end; ++line)
    rays.push_back(
        {Vec3f(grid.corner(grid.start_of(axis, line))), 0, direction, nodes.back() - nodes.front()});
  LineChunk chunk;
  chunk.counts.assign(end - begin, 0);
  std::size_t on_edge = 0;
  for (const ContourSample& sample : sample_rays(accel, rays)) {
    ContourCrossing crossing;
    crossing.place = grid.start_of(axis, begin + sample.ray);
    const auto next = std::ranges::upper_bound(nodes, sample.position[axis], {},
                                               [](float x) { return static_cast<double>(x); });
    crossing.place[k] =
        std::clamp(static_cast<std::int32_t>(next - nodes.begin()) - 1, 0, grid.cells(axis) - 1);
    crossing.at = sample.position[axis], crossing.normal = sample.normal, crossing.user = sample.user;
    crossing.axis = static_cast<std::uint8_t>(axis);
    crossing.turn = sample.normal[axis] >= 0 ? 1 : -1;
    // The bounds hold all of the surface; what rounding moves out of the grid is no part of it.
    bool inner = true;
    for (int a = 0; a < 3; ++a)
      inner = inner && crossing.place[static_cast<std::size_t>(a)] > 0 &&
              crossing.place[static_cast<std::size_t>(a)] + 1 < grid.cells(a);
    if (!inner) continue;
    const bool same = chunk.counts[sample.ray] > 0 && chunk.crossings.back().place == crossing.place;
    on_edge = same ? on_edge + 1 : 1;
    if (on_edge > kMostOnEdge) {
      chunk.crossings.pop_back(), --chunk.counts[sample.ray];
      on_edge -= 2;
      continue;
    }
    chunk.crossings.push_back(crossing), ++chunk.counts[sample.ray];
  }
  return chunk;
}

}  // namespace

ContourCrossings sample_grid(const Accel& accel, const ContourGrid& grid) {
  ContourCrossings found;
  for (int axis = 0; axis < 3; ++axis) {
    const Chunks chunks(grid.lines(axis), kLinesOfTask);
    std::vector<LineChunk> parts(chunks.count);
    chunks.each(true, [&](std::size_t c, std::size_t begin, std::size_t end) {
      parts[c] = sample_lines(accel, grid, axis, begin, end);
    });
    std::vector<std::uint32_t>& begin = found.of_lines[static_cast<std::size_t>(axis)];
    begin.reserve(grid.lines(axis) + 1);
    std::size_t count = found.all.size();
    for (const LineChunk& part : parts) {
      found.all.insert(found.all.end(), part.crossings.begin(), part.crossings.end());
      if (found.all.size() > std::size_t{1} << 29)
        throw Error("the surface crosses more than 2^29 edges of the grid; ask for fewer cells");
      for (const std::uint32_t n : part.counts)
        begin.push_back(static_cast<std::uint32_t>(count)), count += n;
    }
    begin.push_back(static_cast<std::uint32_t>(count));
  }
  return found;
}

}  // namespace oktett
