#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "io/mesh/polygon.h"
#include "tests/io/obj_test_support.h"
#include "tests/io/simple_polygons.h"

namespace oktett::test::polygon_tiling_test {
namespace {

/// How much more is asked than in a usual run; 50 is 10 000 polygons of up to 100 000 corners.
int effort() {
  const char* wanted = std::getenv("OKTETT_POINT_EFFORT");
  return wanted != nullptr ? std::max(1, std::atoi(wanted)) : 1;
}

/// Somewhere in space: turned, sheared, mirrored, tilted, and maybe far away. All numbers stay whole or
/// quarters, of at most 24 bits, so that floats hold them exactly.
std::vector<Vec3f> posed(const Outline& outline, std::mt19937& random) {
  const int quarter = whole(random, 0, 3), shear = whole(random, -1, 1), up = whole(random, 0, 2);
  const bool far = whole(random, 0, 3) == 0;
  Outline turned;
  std::int64_t most = 1;
  for (GridPoint p : outline) {
    for (int k = 0; k < quarter; ++k) p = {-p.y, p.x};
    p.x += shear * p.y;
    turned.push_back(p);
    most = std::max({most, std::abs(p.x), std::abs(p.y)});
  }
  const int room = static_cast<int>(std::min<std::int64_t>((1 << 23) / most, 8));
  const int by_x = whole(random, -room / 2, room / 2), by_y = whole(random, -room / 2, room / 2);
  const std::int64_t away = far && most < 1 << 22 ? 1 << 23 : 0;
  std::vector<Vec3f> points;
  for (const GridPoint& p : turned) {
    const std::int64_t at[3] = {p.x + away, p.y - away, by_x * p.x + by_y * p.y};
    for (const std::int64_t x : at) EXPECT_LE(std::abs(x), 1 << 24);
    points.push_back({static_cast<float>(at[up % 3]), static_cast<float>(at[(up + 1) % 3]),
                      static_cast<float>(at[(up + 2) % 3])});
  }
  return points;
}

/// Each edge of a triangle is one of the polygon's, which all occur once, or two triangles share it.
void expect_a_disk(std::span<const std::uint32_t> triangles, std::size_t corners) {
  std::vector<std::uint64_t> edges, turned;
  for (std::size_t i = 0; i < triangles.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t a = triangles[i + k], b = triangles[i + (k + 1) % 3];
      edges.push_back(a << 32 | b);
      if (b != (a + 1) % corners) turned.push_back(b << 32 | a);
    }
  for (std::uint64_t i = 0; i < corners; ++i) turned.push_back(i << 32 | (i + 1) % corners);
  std::sort(edges.begin(), edges.end()), std::sort(turned.begin(), turned.end());
  EXPECT_EQ(std::adjacent_find(edges.begin(), edges.end()), edges.end());
  EXPECT_EQ(edges, turned);
}

/// The areas of the triangles, none of which is turned over, add up to that of the shoelace formula.
void expect_areas_add_up(std::span<const std::uint32_t> triangles, const SimplePolygon& polygon) {
  const Outline& p = polygon.outline;
  const std::int64_t area = doubled_area(p);
  std::int64_t sum = 0, turned_over = 0, flat = 0;
  for (std::size_t i = 0; i < triangles.size(); i += 3) {
    const std::int64_t part = doubled_area(p[triangles[i]], p[triangles[i + 1]], p[triangles[i + 2]]);
    sum += part, turned_over += part != 0 && (part > 0) != (area > 0), flat += part == 0;
  }
  EXPECT_EQ(sum, area);
  EXPECT_EQ(turned_over, 0);
  if (!polygon.touches) {
    EXPECT_EQ(flat, 0);
  }
}

/// Random points are in one triangle if a line from them crosses the outline an odd number of times, else in
/// none. Those on a line through two corners are left out.
void expect_even_odd(std::span<const std::uint32_t> triangles, const Outline& outline, int points,
                     std::mt19937& random) {
  Outline p;
  GridPoint lo = outline[0], hi = outline[0];
  for (const GridPoint& q : outline) {
    lo = {std::min(lo.x, q.x), std::min(lo.y, q.y)}, hi = {std::max(hi.x, q.x), std::max(hi.y, q.y)};
    p.push_back({8 * q.x, 8 * q.y});
  }
  for (int k = 0; k < points; ++k) {
    const auto between = [&](std::int64_t a, std::int64_t b) {
      return (8 * a + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(8 * (b - a) + 1))) | 1;
    };
    const GridPoint at{between(lo.x, hi.x), between(lo.y, hi.y)};
    bool odd = false, sure = true;
    for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++)
      if ((p[i].y > at.y) != (p[j].y > at.y)) {
        const std::int64_t side = doubled_area(p[i], p[j], at);
        sure &= side != 0;
        odd ^= (side > 0) == (p[j].y > p[i].y);
      }
    int within = 0;
    for (std::size_t i = 0; i < triangles.size() && sure; i += 3) {
      const GridPoint &a = p[triangles[i]], &b = p[triangles[i + 1]], &c = p[triangles[i + 2]];
      const std::int64_t ab = doubled_area(a, b, at), bc = doubled_area(b, c, at),
                         ca = doubled_area(c, a, at);
      within += (ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0);
      if ((ab == 0 || bc == 0 || ca == 0) &&
          ((ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0)))
        sure = false;
    }
    if (!sure) continue;
    EXPECT_EQ(within, odd ? 1 : 0) << at.x << " " << at.y;
  }
}

TEST(PolygonTiling, RandomSimplePolygonsAreTiled) {
  PolygonTriangulator triangulator;
  PolygonSweep sweep;
  std::size_t all = 0, largest = 0;
  std::map<std::string, int> kinds;
  for (int round = 0; round < 200 * effort(); ++round) {
    std::mt19937 random(static_cast<unsigned>(round));
    // As many of each order of magnitude.
    const double most = effort() > 1 ? 1e5 : 8000;
    const int corners = static_cast<int>(5 * std::pow(most / 5, whole(random, 0, 1000) / 1000.0));
    SimplePolygon polygon = simple_polygon(round % kSimplePolygonKinds, corners, random);
    if (whole(random, 0, 1) == 1) add_needless_corners(polygon, random);
    Outline& p = polygon.outline;
    if (p.size() < 5 || doubled_area(p) == 0) continue;
    if (whole(random, 0, 1) == 1) std::reverse(p.begin(), p.end());
    std::rotate(p.begin(), p.begin() + static_cast<std::ptrdiff_t>(random() % p.size()), p.end());
    const auto triangles = triangulator.run(posed(p, random));
    EXPECT_FALSE(triangulator.crosses_itself());
    ASSERT_EQ(triangles.size(), 3 * (p.size() - 2));
    expect_a_disk(triangles, p.size());
    expect_areas_add_up(triangles, polygon);
    expect_even_odd(triangles, p, 10, random);
    // The sweep alone, which large polygons are cut by.
    std::vector<PlanePoint> points;
    const std::int64_t up = doubled_area(p) > 0 ? 1 : -1;
    for (const GridPoint& q : p) points.push_back({static_cast<double>(q.x), static_cast<double>(up * q.y)});
    EXPECT_TRUE(sweep.run(points));
    ASSERT_EQ(sweep.triangles().size(), 3 * (p.size() - 2));
    expect_a_disk(sweep.triangles(), p.size());
    expect_areas_add_up(sweep.triangles(), polygon);
    ASSERT_FALSE(HasFailure()) << "round " << round << ": " << polygon.name << ", " << p.size() << " corners";
    all += p.size(), largest = std::max(largest, p.size()), ++kinds[polygon.name];
  }
  if (effort() == 1) return;
  std::printf("%zu corners, up to %zu a polygon\n", all, largest);
  for (const auto& [name, count] : kinds) std::printf("  %s: %d\n", name.c_str(), count);
}

// Small ones are cut by ears, of which some seem to be none or only seem to be some where corners meet.
TEST(PolygonTiling, BranchesThatTouchAreTiled) {
  PolygonTriangulator triangulator;
  for (int round = 0; round < 1500 * effort(); ++round) {
    std::mt19937 random(static_cast<unsigned>(round));
    SimplePolygon polygon = simple_polygon(8, whole(random, 20, 400), random);
    add_needless_corners(polygon, random);
    const auto triangles = triangulator.run(posed(polygon.outline, random));
    EXPECT_FALSE(triangulator.crosses_itself());
    ASSERT_EQ(triangles.size(), 3 * (polygon.outline.size() - 2));
    expect_a_disk(triangles, polygon.outline.size());
    expect_areas_add_up(triangles, polygon);
    ASSERT_FALSE(HasFailure()) << "round " << round;
  }
}

/// Whether the ray meets the outline's plane z = x / 4 - y / 2 inside of it.
bool is_seen(const Outline& outline, const Ray& ray) {
  using Vec3l = Vec3<long double>;
  const Vec3l o(ray.origin), d(ray.direction), n{0.25L, -0.5L, -1};
  const Vec3l p = o - d * (dot(o, n) / dot(d, n));
  bool odd = false;
  for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
    const auto ax = static_cast<long double>(outline[i].x), ay = static_cast<long double>(outline[i].y),
               bx = static_cast<long double>(outline[j].x), by = static_cast<long double>(outline[j].y);
    if ((ay > p.y) != (by > p.y)) odd ^= p.x < ax + (p.y - ay) / (by - ay) * (bx - ax);
  }
  return odd;
}

// Through a pinhole, as a face of a file, as the shape `polygon`, and by the outline's crossings alone.
TEST(PolygonTiling, AWallIsTheSamePixelsAsAFaceAndAsAShape) {
  const Outline wall = hilbert_wall(5);
  ASSERT_EQ(wall.size(), 2048u);
  std::string vertices, face = "f";
  PolygonShape shape;
  for (const GridPoint& p : wall) {
    const auto x = static_cast<double>(p.x), y = static_cast<double>(p.y);
    shape.vertices.push_back({x, y, x / 4 - y / 2});
    vertices +=
        "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(x / 4 - y / 2) + "\n";
    face += " " + std::to_string(shape.vertices.size());
  }
  const ObjFile file = ObjFiles().load(vertices + face + "\n");
  ASSERT_EQ(file.mesh.triangle_count(), 2046u);
  EXPECT_TRUE(file.warnings.empty());
  RayBatch rays;
  const Vec3f eye{70.3f, 51.7f, 190.2f};
  for (int y = 0; y < 400; ++y)
    for (int x = 0; x < 400; ++x)
      rays.push_back({eye, 0,
                      Vec3f{0.34f * static_cast<float>(x) - 5, 0.34f * static_cast<float>(y) - 5, 0} - eye,
                      std::numeric_limits<float>::infinity()});
  HitBatch as_face, as_shape;
  as_face.resize_uninitialized(rays.size()), as_shape.resize_uninitialized(rays.size());
  closest_hit(*build_accel({{MeshGeometry{&file.mesh}, {}, kNoId}}), rays, as_face);
  closest_hit(*build_accel({{shape, {}, kNoId}}), rays, as_shape);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(as_face[i].valid(), is_seen(wall, rays[i])) << i;
    ASSERT_EQ(as_shape[i].valid(), as_face[i].valid()) << i;
    if (!as_face[i].valid()) continue;
    EXPECT_NEAR(as_face[i].t, as_shape[i].t, 0x1p-22f);
    ++hits;
  }
  EXPECT_GT(hits, rays.size() / 3);
  EXPECT_LT(hits, rays.size() / 2);
}

// ---- Crossings.

bool is_told(const Outline& outline) {
  std::vector<Vec3f> points;
  for (const GridPoint& p : outline) points.push_back({static_cast<float>(p.x), static_cast<float>(p.y), 0});
  PolygonTriangulator triangulator;
  EXPECT_EQ(triangulator.run(points).size(), 3 * (outline.size() - 2));
  return triangulator.crosses_itself();
}

/// Whether no two edges meet but in the corner between them.
bool is_simple(const Outline& p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    const GridPoint &a = p[i], &b = p[(i + 1) % n], &c = p[(i + 2) % n];
    if (a == b || a == c ||
        (doubled_area(a, b, c) == 0 && (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y) < 0))
      return false;
    for (std::size_t j = i + 2; j < n && (i > 0 || j + 1 < n); ++j)
      if (edges_meet(a, b, p[j], p[(j + 1) % n])) return false;
  }
  return true;
}

/// How often an outline winds around a point that is not on it.
int winding_number(const Outline& p, const GridPoint& at) {
  int winding = 0;
  for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
    if (p[j].y <= at.y && p[i].y > at.y) winding += doubled_area(p[j], p[i], at) > 0;
    if (p[i].y <= at.y && p[j].y > at.y) winding -= doubled_area(p[i], p[j], at) > 0;
  }
  return winding;
}

Outline scaled(Outline p, std::int64_t by) {
  for (GridPoint& q : p) q = {by * q.x, by * q.y};
  return p;
}

// Of few corners on few places, so that most touch or cross themselves, in corners and along edges. What is
// not told winds around no point more than once, or the other way round. What becomes simple when its corners
// are moved a little is not told.
TEST(PolygonTiling, CrossingsAreToldApartFromContacts) {
  std::mt19937 random(1);
  int told = 0, untold = 0, moved_apart = 0;
  for (int round = 0; round < 10000 * effort(); ++round) {
    Outline p;
    const int places = whole(random, 2, 5);
    for (int i = whole(random, 5, 9); i > 0; --i)
      p.push_back({whole(random, 0, places), whole(random, 0, places)});
    if (doubled_area(p) == 0) continue;
    const int sense = doubled_area(p) > 0 ? 1 : -1;
    const bool crosses = is_told(p);
    crosses ? ++told : ++untold;
    const Outline fine = scaled(p, 4096);
    std::string text;
    for (const GridPoint& q : p) text += " " + std::to_string(q.x) + "," + std::to_string(q.y);
    for (int k = 0; k < 30; ++k) {
      // On no line through two corners.
      const GridPoint at{static_cast<std::int64_t>(random() % (4096u * 5)),
                         4 * static_cast<std::int64_t>(random() % (1024u * 5)) + 1};
      bool sure = true;
      for (const GridPoint& a : fine)
        for (const GridPoint& b : fine) sure &= a == b || doubled_area(a, b, at) != 0;
      if (!sure || crosses) continue;
      const int times = sense * winding_number(fine, at);
      ASSERT_TRUE(times == 0 || times == 1) << text;
    }
    for (int k = 0; k < 20; ++k) {
      Outline moved = fine;
      for (GridPoint& q : moved) q.x += whole(random, -50, 50), q.y += whole(random, -50, 50);
      if (!is_simple(moved)) continue;
      ASSERT_FALSE(crosses) << text;
      ++moved_apart;
      break;
    }
  }
  EXPECT_GT(told, 1000);
  EXPECT_GT(untold, 100);
  EXPECT_GT(moved_apart, 100);
}

// A corner of a simple polygon is moved anywhere.
TEST(PolygonTiling, OneCrossingIsFound) {
  int crossing = 0, simple = 0;
  for (int round = 0; round < 300 * effort(); ++round) {
    std::mt19937 random(static_cast<unsigned>(round));
    const SimplePolygon polygon =
        simple_polygon(round % kSimplePolygonKinds,
                       static_cast<int>(5 * std::pow(200, whole(random, 0, 100) / 100.0)), random);
    if (polygon.touches || polygon.outline.size() < 5) continue;
    Outline p = polygon.outline;
    const std::size_t n = p.size(), i = random() % n;
    GridPoint lo = p[0], hi = p[0];
    for (const GridPoint& q : p) {
      lo = {std::min(lo.x, q.x), std::min(lo.y, q.y)}, hi = {std::max(hi.x, q.x), std::max(hi.y, q.y)};
    }
    // Half of them near.
    const std::int64_t part = whole(random, 0, 1) == 0 ? 1 : 50;
    const auto near = [&](std::int64_t x, std::int64_t size) {
      return x + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(2 * size / part + 1)) -
             size / part;
    };
    p[i] = {near(p[i].x, hi.x - lo.x), near(p[i].y, hi.y - lo.y)};
    bool proper = false;
    const auto sign = [](std::int64_t x) { return x > 0 ? 1 : x < 0 ? -1 : 0; };
    for (const std::size_t e : {(i + n - 1) % n, i})
      for (std::size_t j = 0; j < n; ++j) {
        const GridPoint &a = p[e], &b = p[(e + 1) % n], &c = p[j], &d = p[(j + 1) % n];
        proper |= sign(doubled_area(a, b, c)) * sign(doubled_area(a, b, d)) < 0 &&
                  sign(doubled_area(c, d, a)) * sign(doubled_area(c, d, b)) < 0;
      }
    if (doubled_area(p) == 0 || (!proper && !is_simple(p))) continue;
    EXPECT_EQ(is_told(p), proper) << round << ": " << polygon.name;
    proper ? ++crossing : ++simple;
  }
  EXPECT_GT(crossing, 50);
  EXPECT_GT(simple, 20);
}

TEST(PolygonTiling, CrossingsInCornersAndAlongEdgesAreFound) {
  // Two triangles that touch in a corner; then the second is passed the other way round.
  EXPECT_FALSE(is_told({{0, 0}, {2, 2}, {4, 0}, {4, 4}, {2, 2}, {0, 5}}));
  EXPECT_TRUE(is_told({{0, 0}, {2, 2}, {4, 4}, {4, 0}, {2, 2}, {0, 5}}));
  // A corner on an edge, from where the way goes back or on.
  EXPECT_FALSE(is_told({{0, 0}, {6, 0}, {6, 6}, {3, 0}, {1, 6}}));
  EXPECT_TRUE(is_told({{0, 0}, {6, 0}, {6, 6}, {3, 0}, {1, -5}}));
  // Along an edge, and off it to the one or the other side.
  EXPECT_FALSE(is_told({{0, 0}, {6, 0}, {6, 4}, {4, 0}, {2, 0}, {1, 2}, {0, 4}}));
  EXPECT_TRUE(is_told({{0, 0}, {6, 0}, {6, 4}, {4, 0}, {2, 0}, {1, -2}, {0, 4}}));
  // Two halves whose areas cancel each other; a way back and forth, which encloses nothing.
  EXPECT_TRUE(is_told({{0, 0}, {6, 0}, {6, 6}, {3, 0}, {1, -6}}));
  EXPECT_FALSE(is_told({{0, 0}, {3, 0}, {3, 4}, {3, 0}, {5, 1}, {3, 0}}));
  // A spike without width across an edge, which encloses nothing either.
  EXPECT_FALSE(is_told({{0, 0}, {4, 0}, {4, 4}, {2, 2}, {2, -2}, {2, 2}, {0, 4}}));
  // A square that is walked twice.
  EXPECT_TRUE(is_told({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}, {1, 0}, {1, 1}, {0, 1}}));
}

TEST(PolygonTiling, ACrossingAmongManyLongEdgesIsFound) {
  Outline p{{0, -1}, {200000, -1}};
  for (int i = 50000; i-- > 0;) p.insert(p.end(), {{4 * i + 2, 0}, {4 * i + 200001, 50000}, {4 * i, 0}});
  EXPECT_FALSE(is_told(p));
  p[3].x += 4;
  EXPECT_FALSE(is_told(p));
  p[6].x += 12;
  EXPECT_TRUE(is_told(p));
}

}  // namespace
}  // namespace oktett::test::polygon_tiling_test
