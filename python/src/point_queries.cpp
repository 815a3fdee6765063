#include "python/src/point_queries.h"

#include <numeric>
#include <span>
#include <vector>

#include "accel/point_query.h"

namespace oktett::python {
namespace {

std::span<const Vec3f> rows(const float* points, std::size_t begin, std::size_t end) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  return {reinterpret_cast<const Vec3f*>(points) + begin, end - begin};
}

/// Columns for the nearest points of one task.
struct Columns {
  Column<float> in[3], point[3], normal[3];
  HitBatch hits;

  void resize(std::size_t size) {
    for (int k = 0; k < 3; ++k)
      in[k].resize_uninitialized(size), point[k].resize_uninitialized(size),
          normal[k].resize_uninitialized(size);
    hits.resize_uninitialized(size);
  }
};

void copy_rows(const Column<float> (&columns)[3], std::size_t size, float* out) {
  if (out == nullptr) return;
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t k = 0; k < 3; ++k) out[3 * i + k] = columns[k][i];
}

}  // namespace

void closest_points(const World& world, const float* points, std::size_t begin, std::size_t end,
                    const ClosestColumns& out) {
  static thread_local Columns columns;
  const std::size_t size = end - begin;
  columns.resize(size);
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t k = 0; k < 3; ++k) columns.in[k][i] = points[3 * (begin + i) + k];
  HitSpan hits = columns.hits.span();
  if (out.distance) hits.t = out.distance + begin;
  ClosestPointSpan closest;
  PointSpan asked;
  for (int k = 0; k < 3; ++k) {
    asked.p[k] = columns.in[k].data();
    if (out.point) closest.point[k] = columns.point[k].data();
    if (out.hit.normal) closest.normal[k] = columns.normal[k].data();
  }
  asked.size = closest.size = size;
  closest.distance = hits.t, closest.u = hits.u, closest.v = hits.v;
  closest.item = hits.item, closest.instance = hits.instance;
  closest_point(*world.accel, asked, closest);
  for (std::size_t i = 0; i < size && out.point; ++i)
    if (hits.item[i] == kNoId)
      out.point.set_miss(begin + i);
    else
      out.point.set(begin + i, {columns.point[0][i], columns.point[1][i], columns.point[2][i]});
  copy_rows(columns.normal, size, out.hit.normal ? out.hit.normal + 3 * begin : nullptr);
  HitColumns named = out.hit;
  named.normal = nullptr;
  static thread_local std::vector<std::size_t> places;
  places.resize(size);
  std::iota(places.begin(), places.end(), begin);
  describe_hits(world, {}, hits, places, named);
}

void inside(const World& world, const float* points, std::size_t begin, std::size_t end, InsideRule rule,
            std::uint8_t* answers) {
  oktett::inside(*world.accel, rows(points, begin, end), std::span(answers + begin, end - begin), rule);
}

void winding_numbers(const World& world, const float* points, std::size_t begin, std::size_t end,
                     double error, float* numbers) {
  winding_number(*world.accel, rows(points, begin, end), std::span(numbers + begin, end - begin), error);
}

void signed_distances(const World& world, const float* points, std::size_t begin, std::size_t end,
                      InsideRule rule, float* distances) {
  signed_distance(*world.accel, rows(points, begin, end), std::span(distances + begin, end - begin), rule);
}

}  // namespace oktett::python
