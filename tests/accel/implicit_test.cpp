#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "accel/accel.h"
#include "kernels/exact/march.h"
#include "kernels/functions/function_tape.h"
#include "tests/accel/all_crossings.h"
#include "tests/support/limits.h"

namespace oktett::implicit_test {
namespace {

ImplicitShape function(const std::string& text, double size, bool open = false) {
  ImplicitShape s;
  s.function = compile_function(text);
  s.lo = {-size, -size, -size}, s.hi = {size, size, size}, s.open = open;
  return s;
}

/// All crossings, after a check that every answer was proved.
std::vector<Hit> crossings_of(const Ray& ray, const ImplicitShape& shape, const Affine& to_world = {}) {
  const std::uint64_t before = interval::uncertified_count();
  const std::vector<Hit> hits = all_crossings(shape, ray, to_world);
  EXPECT_EQ(interval::uncertified_count(), before);
  for (std::size_t i = 1; i < hits.size(); ++i) EXPECT_EQ(hits[i].v, -hits[i - 1].v);
  return hits;
}
std::vector<Hit> crossings(const ImplicitShape& shape, const Vec3f& from, const Vec3f& direction) {
  return crossings_of({from, 0, direction, kInf}, shape);
}

void expect_at(const std::vector<Hit>& hits, std::initializer_list<float> places, float within = 0) {
  ASSERT_EQ(hits.size(), places.size());
  std::size_t i = 0;
  for (const float t : places) {
    EXPECT_NEAR(hits[i].t, t, within) << "crossing " << i;
    EXPECT_EQ(hits[i].v, i % 2 == 0 ? -1 : 1) << "crossing " << i;
    ++i;
  }
}

const char* const kBall = "x^2 + y^2 + z^2 - 1";

/// At a touch the function does not change its sign. A ray a little beside it meets two crossings or none.
TEST(Implicit, Tangents) {
  const ImplicitShape ball = function(kBall, 2);
  EXPECT_TRUE(crossings(ball, {-3, 1, 0}, {1, 0, 0}).empty());
  EXPECT_TRUE(crossings(ball, {-3, std::nextafter(1.0f, 2.0f), 0}, {1, 0, 0}).empty());
  for (const float below : {0x1p-24f, 0x1p-20f, 0x1p-10f}) {
    const float y = 1 - below, half = std::sqrt((1 - y) * (1 + y));
    expect_at(crossings(ball, {-3, y, 0}, {1, 0, 0}), {3 - half, 3 + half}, 3e-7f);
  }
  EXPECT_TRUE(crossings(function("x^2", 1), {-3, 0.3f, 0.2f}, {1, 0, 0}).empty());
  EXPECT_TRUE(crossings(function("abs(x)", 1), {-3, 0.3f, 0.2f}, {1, 0, 0}).empty());
  expect_at(crossings(function("x^3", 1, true), {3, 0.3f, 0.2f}, {-1, 0, 0}), {3}, 1e-5f);
  // Along a line in the surface nothing changes.
  EXPECT_TRUE(crossings(function("x*y*z", 1, true), {-3, 0, 0.5f}, {1, 0, 0}).empty());
  // A cone's tip from the side, and along its axis from outside.
  const ImplicitShape cone = function("y^2 + z^2 - x^2", 1);
  EXPECT_TRUE(crossings(cone, {0, 3, 0}, {0, -1, 0}).empty());
  expect_at(crossings(cone, {3, 0, 0}, {-1, 0, 0}), {2, 4});
}

/// Rays in faces, along edges and through corners of the box, which closes the solid.
TEST(Implicit, EdgesOfTheBox) {
  const ImplicitShape half = function("y", 1);
  expect_at(crossings(half, {-3, -0.5f, 0}, {1, 0, 0}), {2, 4});
  expect_at(crossings(half, {-3, -1, 0}, {1, 0, 0}), {2, 4});
  expect_at(crossings(half, {-3, -1, 1}, {1, 0, 0}), {2, 4});
  EXPECT_TRUE(crossings(half, {-3, std::nextafter(-1.0f, -2.0f), 0}, {1, 0, 0}).empty());
  EXPECT_TRUE(crossings(half, {-3, 0.5f, 0}, {1, 0, 0}).empty());
  expect_at(crossings(half, {0, 3, 0}, {0, -1, 0}), {3, 4});
  // From corner to corner.
  expect_at(crossings(half, {-2, -2, -2}, {1, 1, 1}), {1, 2});
  const std::size_t corner = crossings(half, {-2, 0, 0}, {1, -1, 0}).size();
  EXPECT_TRUE(corner == 0 || corner == 2) << corner;
  const ImplicitShape open = function("y", 1, true);
  expect_at(crossings(open, {0, 3, 0}, {0, -1, 0}), {3});
  EXPECT_TRUE(crossings(open, {-3, -0.5f, 0}, {1, 0, 0}).empty());
  EXPECT_TRUE(crossings(open, {2, 3, 0}, {0, -1, 0}).empty());
  // What lies in a face of the box: a sheet without thickness may be there or not, but is entered and left.
  EXPECT_EQ(crossings(function("y + 1", 1), {0, 3, 0}, {0, -1, 0}).size() % 2, 0u);
  expect_at(crossings(function("y - 1", 1), {0, 3, 0}, {0, -1, 0}), {2, 4});
}

/// Directions with zeros of either sign, short and long ones, and almost axis-parallel ones.
TEST(Implicit, Directions) {
  const ImplicitShape ball = function(kBall, 2);
  for (const float zero : {0.0f, -0.0f, 1e-30f, -1e-30f}) {
    expect_at(crossings(ball, {-3, 0, 0}, {1, zero, zero}), {2, 4});
    expect_at(crossings(ball, {0, 3, 0}, {zero, -1, zero}), {2, 4});
    expect_at(crossings(ball, {0, 0, -3}, {zero, zero, 2}), {1, 2});
  }
  for (const float length : {1e-18f, 1e-6f, 1e6f, 1e18f})
    expect_at(crossings(ball, {-3, 0, 0}, {length, 0, 0}), {2 / length, 4 / length}, 1e-6f / length);
  // The ray's own range counts.
  expect_at(crossings_of({{0, 0, 0}, 0, {1, 0, 0}, 0.5f}, ball), {});
  const auto leaving = crossings(ball, {0, 0, 0}, {1, 0, 0});
  ASSERT_EQ(leaving.size(), 1u);
  EXPECT_EQ(leaving[0].t, 1);
  EXPECT_EQ(leaving[0].v, 1);
}

/// Far origins; the same surface huge and tiny, by the scale of its function and by a transform.
TEST(Implicit, AnyScaleAndPlace) {
  expect_at(crossings(function(kBall, 2), {1e5f, 0, 0}, {-1, 0, 0}), {99999, 100001}, 0.01f);
  const Ray ray{{1e5f, 3, 0}, 0, {0, -1, 0}, kInf};
  expect_at(crossings_of(ray, function(kBall, 2), Affine::translation({1e5, 0, 0})), {2, 4});
  for (const double size : {1e-12, 1e-3, 1e3, 1e12}) {
    SCOPED_TRACE(size);
    const std::string s = std::to_string(std::log2(size));
    const float f = static_cast<float>(size), within = 1e-5f * f;
    const Ray from{{-3 * f, 0, 0}, 0, {1, 0, 0}, kInf};
    expect_at(crossings_of(from, function("(x^2 + y^2 + z^2)/(2^(2*(" + s + "))) - 1", 2 * size)),
              {2 * f, 4 * f}, within);
    expect_at(crossings_of(from, function(kBall, 2), Affine::scaling({size, size, size})), {2 * f, 4 * f},
              within);
  }
}

TEST(Implicit, NothingForNan) {
  for (const char* text : {kBall, "sin(x) + cos(y*z)", "1/x"}) {
    const ImplicitShape s = function(text, 1);
    EXPECT_TRUE(crossings(s, {kNan, 0, 0}, {1, 0, 0}).empty());
    EXPECT_TRUE(crossings(s, {-3, 0.5f, 0}, {1, kNan, 0}).empty());
    EXPECT_TRUE(crossings(s, {-3, 0.5f, 0}, {0, 0, 0}).empty());
    EXPECT_TRUE(crossings(s, {-3, 0.5f, 0}, {kInf, 0, 0}).empty());
    EXPECT_TRUE(crossings_of({{-3, 0.5f, 0}, 0, {1, 0, 0}, kNan}, s).empty());
  }
}

/// The text of min(a, b) and max(a, b), or the same number without branches, which is traced in one cell.
std::string lesser(const std::string& a, const std::string& b, bool branch) {
  return branch ? "min(" + a + ", " + b + ")" : "0.5*(" + a + " + " + b + " - abs(" + a + " - (" + b + ")))";
}
std::string greater(const std::string& a, const std::string& b, bool branch) {
  return branch ? "max(" + a + ", " + b + ")" : "0.5*(" + a + " + " + b + " + abs(" + a + " - (" + b + ")))";
}

/// Balls and a bar, together and cut by a slab; many reach through the faces of the box.
std::string balls_and_bar(bool branch) {
  std::mt19937 random(2);
  const auto at = [&] { return std::to_string(static_cast<double>(random()) / 2147483648.0 - 1); };
  std::string text = greater("abs(x - 0.31) - 0.171", "abs(y + 0.233) - 0.139", branch);
  for (int k = 0; k < 3; ++k) {
    const std::string x = at(), y = at(), z = at();
    const std::string ball =
        "(x - (" + x + "))^2 + (y - (" + y + "))^2 + (z - (" + z + "))^2 - 0." + std::to_string(15 + 6 * k);
    text = lesser(text, ball, branch);
  }
  return greater(text, "abs(x + 0.3*z - 0.1) - 0.777", branch);
}

/// All crossings of a solid in many cells are those of the same solid in one cell.
TEST(Implicit, CellsListEachCrossingOnce) {
  std::mt19937 random(8);
  for (const bool open : {false, true}) {
    const ImplicitShape divided = function(balls_and_bar(true), 1, open);
    const ImplicitShape whole = function(balls_and_bar(false), 1, open);
    const auto divided_accel = build_accel({{ExactShape{divided}, {}}}),
               whole_accel = build_accel({{ExactShape{whole}, {}}});
    std::size_t hits = 0;
    for (int i = 0; i < 2000; ++i) {
      const auto unit = [&] { return static_cast<float>(random() % 65536) / 32768.0f - 1; };
      Ray ray{{3 * unit(), 3 * unit(), 3 * unit()}, 0, {unit(), unit(), unit()}, kInf};
      if (i % 3 == 0) {
        // Along an axis, also along the borders of cells; from outside or inside.
        const auto axis = random() % 3;
        for (unsigned k = 0; k < 3; ++k) {
          ray.origin[k] = static_cast<float>(static_cast<int>(random() % 127) - 63) / 64;
          ray.direction[k] = k == axis ? 1.0f : 0.0f;
        }
        if (random() % 2) ray.origin[axis] = -2;
      } else if (i % 3 == 1) {
        // Into the box from far away.
        ray.direction = Vec3f{unit(), unit(), unit()} * 0.9f - ray.origin;
      }
      const std::vector<Hit> found = all_crossings(*divided_accel, ray),
                             expected = all_crossings(*whole_accel, ray);
      ASSERT_EQ(found.size(), expected.size()) << "ray " << i;
      for (std::size_t k = 0; k < found.size(); ++k) {
        EXPECT_NEAR(found[k].t, expected[k].t, 1e-6f * (1 + expected[k].t));
        EXPECT_EQ(found[k].u, expected[k].u);
        EXPECT_EQ(found[k].v, expected[k].v);
      }
      hits += found.size();
    }
    EXPECT_GT(hits, 1000u);
  }
}

/// Rays that begin anywhere miss none of many crossings in a row.
TEST(Implicit, ListsAllOfMany) {
  const ImplicitShape waves = function("sin(40*x)", 1, true);
  const auto hits = crossings(waves, {-2, 0.1f, 0.2f}, {1, 0, 0});
  ASSERT_EQ(hits.size(), 25u);
  for (std::size_t i = 0; i < hits.size(); ++i)
    EXPECT_NEAR(hits[i].t, 2 + M_PI / 40 * (static_cast<double>(i) - 12), 1e-6);
}

/// The surface interaction at the first hit of a ray.
SurfaceInteraction first_surface(const ImplicitShape& shape, const Ray& ray) {
  const auto accel = build_accel({{ExactShape{shape}, {}}});
  const std::vector<Hit> hits = all_crossings(*accel, ray);
  EXPECT_FALSE(hits.empty());
  return hits.empty() ? SurfaceInteraction{} : surface_interaction(*accel, ray, hits[0]);
}

/// At a pole, a step or the end of the domain, the normal is that of the wall and points outwards, from
/// whichever side the ray comes.
TEST(Implicit, NormalsOfWalls) {
  const struct {
    const char* text;
    Vec3f from, direction, normal;
    float t;
  } kCases[] = {
      {"1/x", {0.5f, 0.2f, 0.1f}, {-1, 0.5f, 0.25f}, {1, 0, 0}, 0.5f},
      {"1/x", {-0.5f, 0.2f, 0.1f}, {1, 0.5f, 0.25f}, {1, 0, 0}, 0.5f},
      {"-1/(x + y)", {0.5f, 0, 0.1f}, {-1, 0.5f, 0.25f}, {-0.70710678f, -0.70710678f, 0}, 1},
      {"y - tan(x)*z", {1.375f, 0, 0.5f}, {1, 0.25f, 0.25f}, {0, 0, 0}, 0.19579633f},
      {"sqrt(x) - 0.5 - y", {-0.5f, 0.2f, 0.1f}, {1, 0.5f, 0.25f}, {-1, 0, 0}, 0.5f},
      {"log(x)", {-0.5f, 0.2f, 0.1f}, {1, 0.5f, 0.25f}, {-1, 0, 0}, 0.5f},
      {"asin(2*y) - 2", {0.1f, 0.75f, 0.1f}, {0.5f, -1, 0.25f}, {0, 1, 0}, 0.25f},
      {"x^1.5 - 1", {-0.5f, 0.2f, 0.1f}, {1, 0.5f, 0.25f}, {-1, 0, 0}, 0.5f},
      {"floor(2*x) + 0.5", {0.75f, 0.2f, 0.1f}, {-1, 0.5f, 0.25f}, {1, 0, 0}, 0.75f},
      {"ceil(2*z) - 0.5", {0.2f, 0.1f, 0.75f}, {0.5f, 0.25f, -1}, {0, 0, 1}, 0.75f},
      {"round(x + y) - 0.5", {0.75f, 0.25f, 0.1f}, {-1, 0, 0.25f}, {0.70710678f, 0.70710678f, 0}, 0.5f},
      {"-sign(y)", {0.2f, -0.5f, 0.1f}, {0.5f, 1, 0.25f}, {0, -1, 0}, 0.5f},
      {"atan2(y, x)", {-0.5f, 0.5f, 0.1f}, {-0.25f, -1, 0}, {0, 1, 0}, 0.5f},
  };
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.text);
    const Ray ray{c.from, 0, c.direction, kInf};
    const ImplicitShape shape = function(c.text, 2, true);
    const std::vector<Hit> hits = crossings_of(ray, shape);
    ASSERT_FALSE(hits.empty());
    EXPECT_NEAR(hits[0].t, c.t, 1e-6f);
    if (length(c.normal) == 0) continue;
    const SurfaceInteraction s = first_surface(shape, ray);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(s.geometric_normal[k], c.normal[k], 1e-3f) << k;
  }
}

}  // namespace
}  // namespace oktett::implicit_test
