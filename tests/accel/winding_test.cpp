#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "accel/point_query.h"
#include "core/error.h"
#include "verify/cases/kernel_cases.h"
#include "verify/oracles/mesh.h"

namespace oktett::winding_test {
namespace {

using Vec3l = Vec3<long double>;

/// How much more is asked than in a usual run; 1000 is a million points of each damaged mesh.
int effort() {
  const char* wanted = std::getenv("OKTETT_POINT_EFFORT");
  return wanted != nullptr ? std::max(1, std::atoi(wanted)) : 1;
}

Vec3l mapped_long(const Affine& m, const Vec3f& p) {
  const Vec3l q(p);
  const auto row = [&](std::size_t i) {
    return static_cast<long double>(m.m[i][0]) * q.x + static_cast<long double>(m.m[i][1]) * q.y +
           static_cast<long double>(m.m[i][2]) * q.z + static_cast<long double>(m.m[i][3]);
  };
  return {row(0), row(1), row(2)};
}

/// By the solid angles of all triangles in extended precision; a map that mirrors keeps the outside. `on`, if
/// it is not null, becomes true if the point is on a triangle, where that may give either side.
long double true_winding(const TriangleMesh& mesh, const Vec3f& point, const Affine& map = {},
                         bool* on = nullptr) {
  long double sum = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    Vec3l v[3];
    long double l[3];
    for (std::size_t k = 0; k < 3; ++k) {
      v[k] = mapped_long(map, mesh.positions[mesh.indices[3 * t + k]]) - Vec3l(point);
      l[k] = std::sqrt(dot(v[k], v[k]));
    }
    const long double size = l[0] * l[1] * l[2], y = dot(v[0], cross(v[1], v[2]));
    const long double x = size + dot(v[0], v[1]) * l[2] + dot(v[1], v[2]) * l[0] + dot(v[2], v[0]) * l[1];
    sum += std::atan2(y, x);
    if (on != nullptr && x <= 1e-17L * size && std::abs(y) <= 1e-17L * size) *on = true;
  }
  return (map.determinant() < 0 ? -sum : sum) / (2 * std::numbers::pi_v<long double>);
}

using Corners = std::array<Vec3f, 3>;

std::vector<Corners> triangles_of(const TriangleMesh& mesh) {
  std::vector<Corners> all;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    all.push_back({mesh.positions[mesh.indices[i]], mesh.positions[mesh.indices[i + 1]],
                   mesh.positions[mesh.indices[i + 2]]});
  return all;
}

TriangleMesh mesh_of(const std::vector<Corners>& triangles) {
  TriangleMesh mesh;
  for (const Corners& t : triangles)
    for (const Vec3f& c : t) {
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(c);
    }
  return mesh;
}

TriangleMesh turned(const TriangleMesh& mesh) {
  std::vector<Corners> all = triangles_of(mesh);
  for (Corners& t : all) std::swap(t[0], t[1]);
  return mesh_of(all);
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  std::vector<Corners> all = triangles_of(a);
  for (const Corners& t : triangles_of(b)) all.push_back(t);
  return mesh_of(all);
}

struct Damaged {
  std::string name;
  TriangleMesh mesh;
};

/// Four closed meshes with five kinds of damage each.
std::vector<Damaged> damaged_meshes() {
  std::vector<Damaged> all;
  CaseRandom random(11);
  for (const OracleMesh& base :
       {make_icosphere(2), make_torus(20, 12), make_globe(24, 8), make_needles(60)}) {
    const std::vector<Corners> whole = triangles_of(base.mesh);
    const auto add = [&](const char* damage, const std::vector<Corners>& triangles) {
      all.push_back({base.name + " " + damage, mesh_of(triangles)});
    };
    std::vector<Corners> holes, doubled, flipped, soup, crossing = whole;
    for (const Corners& t : whole) {
      if (random.unit() < 0.8) holes.push_back(t);
      for (int k = random.unit() < 0.2 ? 3 : 1; k-- > 0;) doubled.push_back(t);
      flipped.push_back(t);
      if (random.unit() < 0.2) std::swap(flipped.back()[0], flipped.back()[1]);
      soup.push_back(t);
      for (Vec3f& c : soup.back()) c += Vec3f(random.vector() * 0.02);
      Corners moved = t;
      for (Vec3f& c : moved) c = Vec3f{c.y, c.z, c.x} * 0.9f + Vec3f{0.2f, 0.1f, 0};
      crossing.push_back(moved);
    }
    add("with holes", holes), add("with doubled faces", doubled), add("with turned faces", flipped);
    add("as a soup", soup), add("that crosses itself", crossing);
  }
  return all;
}

/// Points in and around the bounds, near faces, and some far away.
std::vector<Vec3f> points_around(const TriangleMesh& mesh, int count, std::uint64_t seed) {
  CaseRandom random(seed);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i) {
    const std::size_t t = 3 * (random.bits() % mesh.triangle_count());
    const Vec3f on = (mesh.positions[mesh.indices[t]] + mesh.positions[mesh.indices[t + 1]] +
                      mesh.positions[mesh.indices[t + 2]]) *
                     (1.0f / 3);
    if (i % 4 == 0)
      points.push_back(on + Vec3f(random.vector() * random.magnitude(-6, 0)));
    else if (i % 64 == 1)
      points.push_back(Vec3f(random.vector() * random.magnitude(1, 8)));
    else
      points.push_back(Vec3f(random.vector() * 1.3));
  }
  return points;
}

std::vector<float> numbers_of(const Accel& accel, const std::vector<Vec3f>& points, double error, Isa isa) {
  std::vector<float> numbers(points.size());
  winding_number(accel, points, numbers, error, isa);
  return numbers;
}

/// Answers by the rule of winding numbers, the same on every instruction set.
std::vector<std::uint8_t> ask(const Accel& accel, const std::vector<Vec3f>& points) {
  std::vector<std::uint8_t> answers(points.size(), 7);
  inside(accel, points, answers, InsideRule::winding, Isa::scalar);
  for (const Isa isa : available_isas()) {
    std::vector<std::uint8_t> other(points.size(), 7);
    inside(accel, points, other, InsideRule::winding, isa);
    EXPECT_EQ(other, answers) << to_string(isa);
  }
  for (std::size_t i = 0; i < points.size(); i += 97)
    EXPECT_EQ(inside(accel, points[i], InsideRule::winding), answers[i] == 1);
  return answers;
}

std::shared_ptr<const Accel> built(const TriangleMesh& mesh, const Affine& m = {}) {
  return build_accel({{MeshGeometry{&mesh}, m, kNoId}});
}

TEST(Winding, InsideIsThatOfAllSolidAngles) {
  std::uint64_t seed = 0;
  for (const Damaged& d : damaged_meshes()) {
    const auto accel = built(d.mesh);
    const std::vector<Vec3f> points = points_around(d.mesh, 1000 * effort(), ++seed);
    std::vector<std::uint8_t> answers(points.size());
    if (effort() == 1)
      answers = ask(*accel, points);
    else
      inside(*accel, points, answers, InsideRule::winding);
    std::atomic<int> wrong = 0, ties = 0, in = 0, on_faces = 0;
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
      bool on = false;
      const long double w = std::abs(true_winding(d.mesh, points[i], {}, &on));
      if (on)
        ++on_faces;
      else if (std::abs(w - 0.5L) < 1e-15L)
        ++ties;
      else if ((w > 0.5L) != (answers[i] == 1))
        ++wrong;
      in += answers[i];
    });
    EXPECT_EQ(wrong, 0) << d.name;
    EXPECT_GT(in, 0) << d.name;
    EXPECT_LE(on_faces * 100, points.size()) << d.name;
    if (effort() > 1)
      std::printf("%s: %zu triangles, %zu points, %d inside, %d wrong, %d at 1/2, %d on faces\n",
                  d.name.c_str(), d.mesh.triangle_count(), points.size(), in.load(), wrong.load(),
                  ties.load(), on_faces.load());
  }
}

TEST(Winding, NumbersAreOffByAtMostTheirError) {
  std::uint64_t seed = 100;
  for (const Damaged& d : damaged_meshes()) {
    const auto accel = built(d.mesh);
    const std::vector<Vec3f> points = points_around(d.mesh, 200, ++seed);
    for (const double error : {0.4, 1e-2, 1e-4, 1e-6}) {
      const std::vector<float> numbers = numbers_of(*accel, points, error, Isa::scalar);
      for (const Isa isa : available_isas())
        EXPECT_EQ(numbers_of(*accel, points, error, isa), numbers) << to_string(isa);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const long double w = true_winding(d.mesh, points[i]);
        ASSERT_LE(std::abs(w - numbers[i]), error + 0x1p-24L * std::abs(w)) << d.name << ", point " << i;
      }
      EXPECT_EQ(winding_number(*accel, points[3], error), numbers[3]);
    }
  }
}

// Too many open edges to close.
TEST(Winding, OfSoups) {
  CaseRandom random(21);
  std::vector<Corners> all;
  for (const Corners& t : triangles_of(make_icosphere(4).mesh)) {
    all.push_back(t);
    for (Vec3f& c : all.back()) c += Vec3f(random.vector() * 0.01);
    if (random.unit() < 0.1) std::swap(all.back()[0], all.back()[1]);
  }
  const TriangleMesh soup = mesh_of(all);
  const auto accel = built(soup);
  const std::vector<Vec3f> points = points_around(soup, 150, 7);
  const std::vector<std::uint8_t> answers = ask(*accel, points);
  for (const double error : {1e-1, 1e-3, 1e-5}) {
    const std::vector<float> numbers = numbers_of(*accel, points, error, Isa::scalar);
    for (const Isa isa : available_isas())
      EXPECT_EQ(numbers_of(*accel, points, error, isa), numbers) << to_string(isa);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const long double w = true_winding(soup, points[i]);
      ASSERT_LE(std::abs(w - numbers[i]), error + 0x1p-23L) << "point " << i;
      ASSERT_EQ(answers[i] == 1, std::abs(w) > 0.5L) << "point " << i;
    }
  }
}

TEST(Winding, HoldsUnderMapsAndInInstances) {
  const std::vector<Damaged> meshes = damaged_meshes();
  CaseRandom random(4);
  for (int number = 0; number < 40; ++number) {
    const TriangleMesh& mesh = meshes[static_cast<std::size_t>(number) % meshes.size()].mesh;
    const bool distorts = number % 2 == 1;
    const auto map = [&] {
      const double s = random.magnitude(-1, 1);
      return Affine::translation(random.vector()) * Affine::rotation(random.vector() * 180.0) *
             Affine::scaling({distorts ? 0.4 * s : s, number % 3 == 0 ? -s : s, s});
    };
    const Affine outer = map(), inner = map(), listed = map();
    InstanceList list{{built(mesh, inner)}, {{{}, 0, kNoId}, {{}, 0, kNoId}}};
    listed.to_rows(list.places[0].to_list), map().to_rows(list.places[1].to_list);
    const auto child = build_accel({{MeshGeometry{&mesh}, inner, kNoId}, {list, {}, kNoId}});
    const auto accel =
        build_accel({{InstanceGeometry{child}, outer, kNoId}, {MeshGeometry{&mesh}, {}, kNoId}});
    std::vector<Vec3f> points;
    for (int i = 0; i < 60; ++i)
      points.push_back(
          Vec3f((i % 2 == 0 ? Affine{} : outer).point(random.vector() * random.magnitude(-1, 1))));
    const std::vector<std::uint8_t> answers = ask(*accel, points);
    const std::vector<float> numbers = numbers_of(*accel, points, 1e-4, default_isa());
    for (std::size_t i = 0; i < points.size(); ++i) {
      // Maps of lists are traced in float, and corners are rounded to float where the mesh stands.
      long double w = true_winding(mesh, points[i]) + true_winding(mesh, points[i], outer * inner);
      for (const InstancePlace& place : list.places)
        w += true_winding(mesh, points[i], outer * Affine::from_rows(place.to_list) * inner);
      ASSERT_NEAR(static_cast<double>(w), numbers[i], 2e-3) << number << ", point " << i;
      if (std::abs(std::abs(w) - 0.5L) <= 2e-3L) continue;
      ASSERT_EQ(answers[i] == 1, std::abs(w) > 0.5L) << number << ", point " << i;
    }
  }
}

TEST(Winding, OfManyInstancesAtOnce) {
  const TriangleMesh ball = make_icosphere(1).mesh;
  for (const double flat : {1.0, 0.5}) {
    InstanceList list{{built(ball)}, {}};
    CaseRandom random(9);
    for (int i = 0; i < 200; ++i) {
      InstancePlace place{{}, 0, kNoId};
      (Affine::translation(random.vector()) * Affine::scaling({0.05, 0.05 * flat, 0.05}))
          .to_rows(place.to_list);
      list.places.push_back(place);
    }
    const auto accel = build_accel({{list, {}, kNoId}});
    for (int i = 0; i < 150; ++i) {
      const Vec3f p(random.vector());
      long double w = 0;
      for (const InstancePlace& place : list.places)
        w += true_winding(ball, p, Affine::from_rows(place.to_list));
      EXPECT_NEAR(winding_number(*accel, p), static_cast<double>(w), 2e-4);
      EXPECT_EQ(inside(*accel, p, InsideRule::winding), std::abs(w) > 0.5L);
    }
  }
}

TEST(Winding, AnyThreadMayAskFirst) {
  const TriangleMesh ball = make_icosphere(3).mesh;
  for (int round = 0; round < 20; ++round) {
    const auto child = built(ball);
    const auto accel = build_accel({{InstanceGeometry{child}, Affine::scaling({2, 1, 1}), kNoId},
                                    {InstanceGeometry{child}, Affine::translation({9, 0, 0}), kNoId}});
    std::atomic<int> wrong = 0;
    tbb::parallel_for(0, 64, [&](int i) {
      const float x = 0.05f * static_cast<float>(i);
      const InsideRule rule = i % 2 == 0 ? InsideRule::winding : InsideRule::crossings;
      if (inside(*accel, {x, 0, 0}, rule) != (x < 2)) ++wrong;
    });
    EXPECT_EQ(wrong, 0);
  }
}

TEST(Winding, OfHugeTinyAndFarMeshes) {
  const TriangleMesh ball = make_icosphere(2).mesh;
  const TriangleMesh open = damaged_meshes()[0].mesh;
  const std::vector<Vec3f> around = points_around(open, 200, 5);
  for (const double scale : {1e-36, 1e-30, 1e-3, 1e3, 1e30})
    for (const double offset : {0.0, 100.0, 1e5}) {
      const TriangleMesh mesh = placed(open, scale, Vec3d{offset, -offset, offset} * scale);
      const auto accel = built(mesh);
      std::vector<Vec3f> points;
      for (const Vec3f& p : around)
        points.push_back(Vec3f((Vec3d(p) + Vec3d{offset, -offset, offset}) * scale));
      const std::vector<std::uint8_t> answers = ask(*accel, points);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const long double w = true_winding(mesh, points[i]);
        // Far from the origin many points lie on faces.
        if (std::abs(std::abs(w) - 0.5L) <= 1e-12L ||
            near_surface(mesh, Vec3d(points[i]), scale * offset * 1e-9))
          continue;
        ASSERT_EQ(answers[i] == 1, std::abs(w) > 0.5L) << scale << " " << offset << " " << i;
      }
      for (const float far : {1e4f, 1e20f, 3e38f}) {
        EXPECT_NEAR(winding_number(*accel, {far, far, -far}), 0, 2.0 * scale * scale);
        EXPECT_FALSE(inside(*accel, {far, 0, far}, InsideRule::winding) && far > 1e3f * scale * (1 + offset));
      }
    }
}

TEST(Winding, OnASurfaceIsTheMeanOfBothSides) {
  const TriangleMesh cube = make_cube().mesh;
  const auto accel = built(cube);
  EXPECT_EQ(winding_number(*accel, {1, 0.25f, 0.125f}), 0.5f);
  EXPECT_EQ(winding_number(*accel, {1, 0, 0}), 0.5f);
  EXPECT_EQ(winding_number(*accel, {1, 1, 0.25f}), 0.25f);
  EXPECT_EQ(winding_number(*accel, {-1, 1, 1}), 0.125f);
  for (const Vec3f& p : {Vec3f{1, 0.25f, 0.125f}, Vec3f{1, 0, 0}, Vec3f{1, 1, 0.25f}, Vec3f{-1, 1, 1}})
    EXPECT_FALSE(inside(*accel, p, InsideRule::winding));
  EXPECT_TRUE(inside(*accel, {0x1.fffffep-1f, 0.25f, 0.125f}, InsideRule::winding));
  EXPECT_FALSE(inside(*accel, {0x1.000002p0f, 0.25f, 0.125f}, InsideRule::winding));
  // Without its top, the cube winds half around all points of the opening.
  std::vector<Corners> walls = triangles_of(cube);
  std::erase_if(walls, [](const Corners& t) { return t[0].z == 1 && t[1].z == 1 && t[2].z == 1; });
  const TriangleMesh box = mesh_of(walls);
  const auto open = built(box);
  for (int i = 0; i < 100; ++i) {
    const float x = -0.99f + 0.0198f * static_cast<float>(i);
    EXPECT_NEAR(winding_number(*open, {x, 0.3f, 1}), 0.5, 1e-4);
    EXPECT_FALSE(inside(*open, {x, 0.3f, 1}, InsideRule::winding));
    EXPECT_TRUE(inside(*open, {x, 0.3f, 0x1.fffffcp-1f}, InsideRule::winding));
    EXPECT_FALSE(inside(*open, {x, 0.3f, 0x1.000004p0f}, InsideRule::winding));
  }
}

TEST(Winding, OfWhatIsNoSurface) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  TriangleMesh empty, thin;
  for (const Vec3f& p :
       {Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{2, 0, 0}, Vec3f{nan, 0, 0}, Vec3f{1, 1, inf}, Vec3f{0, 1, 0}})
    thin.positions.push_back(p);
  for (const std::uint32_t i : {0u, 1u, 2u, 0u, 0u, 1u, 2u, 2u, 2u, 0u, 1u, 3u, 0u, 4u, 5u})
    thin.indices.push_back(i);
  for (const TriangleMesh* mesh : {&empty, &thin}) {
    const auto accel = built(*mesh);
    for (const Vec3f& p : {Vec3f{0.5f, 0, 0}, Vec3f{0, 0, 0}, Vec3f{0.3f, 0.1f, 0}, Vec3f{0.3f, 1e-30f, 0}}) {
      EXPECT_EQ(winding_number(*accel, p), 0);
      EXPECT_FALSE(inside(*accel, p, InsideRule::winding));
    }
  }
  EXPECT_EQ(winding_number(*build_accel({}), {0, 0, 0}), 0);
  const TriangleMesh cube = make_cube().mesh;
  const auto accel = built(cube);
  for (const Vec3f& p : {Vec3f{nan, 0, 0}, Vec3f{0, inf, 0}, Vec3f{0, 0, -inf}}) {
    EXPECT_TRUE(std::isnan(winding_number(*accel, p)));
    EXPECT_FALSE(inside(*accel, p, InsideRule::winding));
  }
  EXPECT_THROW(winding_number(*accel, {0, 0, 0}, 0), Error);
  EXPECT_THROW(winding_number(*accel, {0, 0, 0}, nan), Error);
  std::vector<Vec3f> points(2);
  std::vector<float> numbers(3);
  EXPECT_THROW(winding_number(*accel, points, numbers), Error);
}

TEST(Winding, OtherSolidsCountOnceEach) {
  const TriangleMesh cube = make_cube().mesh;
  const auto accel = build_accel({{MeshGeometry{&cube}, {}, kNoId},
                                  {SpheresShape{{{{0, 0, 0}, 1}, {{0.5, 0, 0}, 1}}}, {}, kNoId},
                                  {PlaneShape{{0, 1, 0}, -0.5}, {}, kNoId},
                                  {DiskShape{{0, 0, 0}, {0, 1, 0}, 5}, {}, kNoId}});
  EXPECT_NEAR(winding_number(*accel, {0.125f, 0.25f, 0}), 3, 1e-4);
  EXPECT_NEAR(winding_number(*accel, {0.125f, -0.75f, 0}), 4, 1e-4);
  EXPECT_NEAR(winding_number(*accel, {-0.9f, 0, 0}), 2, 1e-4);
  EXPECT_NEAR(winding_number(*accel, {1.25f, 0.25f, 0}), 1, 1e-4);
  EXPECT_NEAR(winding_number(*accel, {30, -0.75f, 0}), 1, 1e-4);
  EXPECT_TRUE(inside(*accel, {1.25f, 0.25f, 0}, InsideRule::winding));
  EXPECT_FALSE(inside(*accel, {3, 0.25f, 0}, InsideRule::winding));
}

TEST(Winding, GivesDistancesTheirSign) {
  const TriangleMesh open = damaged_meshes()[0].mesh;
  const auto accel = built(open);
  const std::vector<Vec3f> points = points_around(open, 500, 6);
  std::vector<float> distances(points.size());
  signed_distance(*accel, points, distances, InsideRule::winding);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float d = closest_point(*accel, points[i]).distance;
    EXPECT_EQ(distances[i], inside(*accel, points[i], InsideRule::winding) ? -d : d);
    EXPECT_EQ(signed_distance(*accel, points[i], InsideRule::winding), distances[i]);
  }
}

// ---- One rule for inside(), for combinations and for winding numbers.

CsgExpression operand(const Geometry& g) { return {CsgOp::operand, {g}, {}}; }

Geometry combined(CsgOp op, std::vector<CsgExpression> children) {
  return {
      CsgGeometry{std::make_shared<CsgExpression>(CsgExpression{op, {}, std::move(children)})}, {}, kNoId};
}

/// Balls that one mesh holds, each wound outwards or inwards.
TriangleMesh balls(const std::vector<std::pair<Affine, bool>>& all) {
  TriangleMesh mesh;
  for (const auto& [map, inwards] : all) {
    TriangleMesh ball = make_icosphere(2).mesh;
    for (Vec3f& p : ball.positions) p = Vec3f(map.point(Vec3d(p)));
    mesh = joined(mesh, inwards ? turned(ball) : ball);
  }
  return mesh;
}

Affine at(double x, double size) {
  return Affine::translation({x, 0, 0}) * Affine::scaling({size, size, size});
}

/// A cube whose faces are wound as chance has it.
TriangleMesh mixed_cube() {
  std::vector<Corners> all = triangles_of(make_cube().mesh);
  for (std::size_t i = 0; i < all.size(); i += 3) std::swap(all[i][0], all[i][1]);
  return mesh_of(all);
}

/// inside(), the same mesh in combinations and in instances of them, and the crossings of rays with these say
/// the same as `expected` at points that are not near the surface.
template <class Expected>
void check_one_rule(const std::string& name, const TriangleMesh& mesh, const Expected& expected) {
  const Geometry g{MeshGeometry{&mesh}, {}, kNoId};
  const Geometry room{BoxShape{{-9, -9, -9}, {9, 9, 9}}, {}, kNoId};
  const auto alone = build_accel({g}), split = build_accel({g}, {.quality = BuildQuality::best});
  const auto unite = build_accel({combined(CsgOp::unite, {operand(g)})});
  const auto carved = build_accel({combined(CsgOp::subtract, {operand(room), operand(g)})});
  const Geometry shown{InstanceGeometry{alone}, Affine::scaling({1, 1, -1}), kNoId};
  const auto instance = build_accel({combined(CsgOp::unite, {operand(shown)})});
  CaseRandom random(8);
  for (int i = 0; i < 1500; ++i) {
    const Vec3f p = Vec3f(random.vector() * 3.5);
    if (near_surface(mesh, Vec3d(p), 1e-3)) continue;
    const bool in = expected(p);
    const Vec3f mirrored{p.x, p.y, -p.z};
    ASSERT_EQ(inside(*alone, p), in) << name << ": " << p.x << " " << p.y << " " << p.z;
    ASSERT_EQ(inside(*split, p), in) << name;
    ASSERT_EQ(inside(*unite, p), in) << name << ": " << p.x << " " << p.y << " " << p.z;
    ASSERT_EQ(inside(*carved, p), !in) << name;
    ASSERT_EQ(inside(*instance, mirrored), in) << name;
    // Along any ray the combination begins and ends where membership changes.
    const Vec3f d = Vec3f(normalize(random.vector()));
    std::vector<Hit> hits;
    all_hits(*unite, Ray{p, 0, d, std::numeric_limits<float>::infinity()}, hits);
    ASSERT_EQ(hits.size() % 2 == 1, in) << name;
    for (std::size_t k = 0; k < hits.size(); ++k) {
      const float next = k + 1 < hits.size() ? hits[k + 1].t : hits[k].t + 1;
      const Vec3f between = p + d * (0.5f * (hits[k].t + next));
      if (near_surface(mesh, Vec3d(between), 1e-3)) continue;
      ASSERT_EQ(expected(between), in != (k % 2 == 0)) << name;
    }
  }
}

TEST(Winding, IsTheOneRuleOfInsideAndCombinations) {
  const std::pair<const char*, TriangleMesh> meshes[] = {
      {"a shell in a shell", balls({{at(0, 2), false}, {at(0, 1), false}})},
      {"a hollow ball", balls({{at(0, 2), false}, {at(0, 1), true}})},
      {"a hollow ball inside out", balls({{at(0, 2), true}, {at(0, 1), false}})},
      {"three shells", balls({{at(0, 3), false}, {at(0, 2), true}, {at(0.3, 1), false}})},
      {"overlapping balls", balls({{at(0, 1), false}, {at(1, 1.2), false}})},
      {"overlapping balls inside out", balls({{at(0, 1), true}, {at(1, 1.2), true}})},
      {"balls side by side, one inside out", balls({{at(-1.5, 1), false}, {at(1.5, 1.2), true}})},
      {"balls side by side, the other inside out", balls({{at(-1.5, 1), true}, {at(1.5, 1.2), false}})},
      {"overlapping balls of two senses", balls({{at(0, 1), false}, {at(1, 1.2), true}})},
      {"a ball twice", balls({{at(0, 2), false}, {at(0, 2), false}})},
      {"a torus through itself",
       joined(make_torus(24, 12).mesh, placed(make_torus(24, 12).mesh, 1, {0.7, 0.3, 0}))},
  };
  for (const auto& [name, mesh] : meshes) {
    const auto accel = built(mesh);
    check_one_rule(name, mesh, [&m = mesh](const Vec3f& p) { return std::abs(true_winding(m, p)) > 0.5L; });
    CaseRandom random(2);
    for (int i = 0; i < 300; ++i) {
      const Vec3f p = Vec3f(random.vector() * 3.5);
      if (near_surface(mesh, Vec3d(p), 1e-3)) continue;
      ASSERT_EQ(inside(*accel, p, InsideRule::winding), inside(*accel, p)) << name;
    }
  }
}

TEST(Winding, FacesWoundAgainstEachOtherEncloseWhatTheyDid) {
  const TriangleMesh cube = mixed_cube();
  const auto in_cube = [](const Vec3f& p) {
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < 1;
  };
  check_one_rule("a cube of mixed faces", cube, in_cube);
}

// Open meshes: a ray from inside that leaves through a face, or from outside that does not enter by a hole.
TEST(Winding, OpenMeshesAreJudgedAlikeByRays) {
  std::vector<Corners> walls = triangles_of(make_cube().mesh);
  std::erase_if(walls, [](const Corners& t) { return t[0].y == -1 && t[1].y == -1 && t[2].y == -1; });
  const TriangleMesh open = mesh_of(walls), inverted = turned(open);
  for (const TriangleMesh* mesh : {&open, &inverted}) {
    const Geometry g{MeshGeometry{mesh}, {}, kNoId};
    const auto alone = build_accel({g}), unite = build_accel({combined(CsgOp::unite, {operand(g)})});
    CaseRandom random(3);
    for (int i = 0; i < 2000; ++i) {
      const Vec3f p = Vec3f(random.vector() * 2.0);
      if (near_surface(*mesh, Vec3d(p), 1e-3)) continue;
      ASSERT_EQ(inside(*unite, p), inside(*alone, p)) << p.x << " " << p.y << " " << p.z;
    }
    EXPECT_TRUE(inside(*alone, {0.1f, 0, 0.1f}));
    EXPECT_FALSE(inside(*alone, {0.1f, 1.5f, 0.1f}));
  }
}

}  // namespace
}  // namespace oktett::winding_test
