#include "accel/point_query.h"

#include <algorithm>
#include <vector>

#include "accel/batch_pieces.h"
#include "accel/inside.h"
#include "accel/point_code.h"

namespace oktett {
namespace {

/// Larger batches are answered in pieces of this size, each a task.
constexpr std::size_t kPiecePoints = 1024;

/// Calls answer(begin, end) for each piece of a batch.
template <class Answer>
void for_each_points(std::size_t size, Answer&& answer) {
  if (size <= kPiecePoints) return answer(std::size_t{0}, size);
  for_each_task((size + kPiecePoints - 1) / kPiecePoints,
                [&](std::size_t k) { answer(k * kPiecePoints, std::min(size, (k + 1) * kPiecePoints)); });
}

void require_closest(const Accel& accel, const char* query) {
  if (!accel.no_closest_point[0].empty())
    throw Error(
        std::string(query) + ": " + accel.no_closest_point[0] +
        " has no nearest points; meshes, spheres, boxes, planes, disks, polygons, cylinders, cones and "
        "tori have. Ask it with rays or with inside()");
}

/// The points from number `begin` on, in columns. They are valid until the thread's next call.
PointSpan point_columns(std::span<const Vec3f> points, std::size_t begin, std::size_t count) {
  static thread_local std::vector<float> columns[3];
  PointSpan span{{}, count};
  for (int k = 0; k < 3; ++k) {
    columns[k].resize(count);
    for (std::size_t i = 0; i < count; ++i) columns[k][i] = points[begin + i][k];
    span.p[k] = columns[k].data();
  }
  return span;
}

PointSpan point_columns(const PointSpan& points, std::size_t begin, std::size_t count) {
  return points.part(begin, count);
}

/// Calls take(i, Nearest) for each point.
template <class Points, class Take>
void find_nearest(const Accel& accel, const Points& points, std::size_t size, Isa isa, Take&& take) {
  const PointCode& code = point_code(isa);
  for_each_points(size, [&](std::size_t begin, std::size_t end) {
    Nearest nearest[kPiecePoints];
    code.closest(accel, point_columns(points, begin, end - begin), nearest);
    for (std::size_t i = begin; i < end; ++i) take(i, nearest[i - begin]);
  });
}

template <class Points>
void find_inside(const Accel& accel, const Points& points, std::span<std::uint8_t> answers, Isa isa) {
  const InsideTest test(accel, isa);
  for_each_points(answers.size(), [&](std::size_t begin, std::size_t end) {
    test(point_columns(points, begin, end - begin), answers.data() + begin);
  });
}

template <class Points>
void find_distances(const Accel& accel, const Points& points, std::span<float> distances, Isa isa) {
  require_closest(accel, "signed_distance");
  const PointCode& code = point_code(isa);
  const InsideTest test(accel, isa);
  for_each_points(distances.size(), [&](std::size_t begin, std::size_t end) {
    Nearest nearest[kPiecePoints];
    std::uint8_t answers[kPiecePoints];
    const PointSpan columns = point_columns(points, begin, end - begin);
    code.closest(accel, columns, nearest);
    test(columns, answers);
    for (std::size_t i = begin; i < end; ++i) {
      const float distance = distance_of(nearest[i - begin]);
      distances[i] = answers[i - begin] != 0 ? -distance : distance;
    }
  });
}

}  // namespace

void closest_point(const Accel& accel, const PointSpan& points, const ClosestPointSpan& closest, Isa isa) {
  require_same_size(points.size, closest.size, "closest_point", "points");
  require_closest(accel, "closest_point");
  find_nearest(accel, points, points.size, isa, [&](std::size_t i, const Nearest& nearest) {
    closest.set(i, closest_surface(accel, points[i], nearest));
  });
}

void closest_point(const Accel& accel, std::span<const Vec3f> points, std::span<ClosestPoint> closest,
                   Isa isa) {
  require_same_size(points.size(), closest.size(), "closest_point", "points");
  require_closest(accel, "closest_point");
  find_nearest(accel, points, points.size(), isa, [&](std::size_t i, const Nearest& nearest) {
    closest[i] = closest_surface(accel, points[i], nearest);
  });
}

ClosestPoint closest_point(const Accel& accel, const Vec3f& point, Isa isa) {
  ClosestPoint closest;
  closest_point(accel, {&point, 1}, {&closest, 1}, isa);
  return closest;
}

void inside(const Accel& accel, const PointSpan& points, std::span<std::uint8_t> answers, Isa isa) {
  require_same_size(points.size, answers.size(), "inside", "points");
  find_inside(accel, points, answers, isa);
}

void inside(const Accel& accel, std::span<const Vec3f> points, std::span<std::uint8_t> answers, Isa isa) {
  require_same_size(points.size(), answers.size(), "inside", "points");
  find_inside(accel, points, answers, isa);
}

bool inside(const Accel& accel, const Vec3f& point, Isa isa) {
  std::uint8_t answer = 0;
  inside(accel, {&point, 1}, {&answer, 1}, isa);
  return answer != 0;
}

void signed_distance(const Accel& accel, const PointSpan& points, std::span<float> distances, Isa isa) {
  require_same_size(points.size, distances.size(), "signed_distance", "points");
  find_distances(accel, points, distances, isa);
}

void signed_distance(const Accel& accel, std::span<const Vec3f> points, std::span<float> distances, Isa isa) {
  require_same_size(points.size(), distances.size(), "signed_distance", "points");
  find_distances(accel, points, distances, isa);
}

float signed_distance(const Accel& accel, const Vec3f& point, Isa isa) {
  float distance = 0;
  signed_distance(accel, {&point, 1}, {&distance, 1}, isa);
  return distance;
}

}  // namespace oktett
