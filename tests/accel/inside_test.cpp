#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "accel/point_query.h"
#include "core/error.h"
#include "verify/oracles/known_shapes.h"
#include "verify/oracles/mesh.h"

namespace oktett::inside_test {
namespace {

/// How much more is asked than in a usual run.
int effort() {
  const char* wanted = std::getenv("OKTETT_POINT_EFFORT");
  return wanted != nullptr ? std::max(1, std::atoi(wanted)) : 1;
}

std::vector<std::uint8_t> ask(const Accel& accel, const std::vector<Vec3f>& points, Isa isa) {
  std::vector<std::uint8_t> answers(points.size(), 7);
  inside(accel, points, answers, isa);
  return answers;
}

/// The answers, after a check that they are the same on every instruction set and by every way to ask.
std::vector<std::uint8_t> ask(const Accel& accel, const std::vector<Vec3f>& points) {
  const std::vector<std::uint8_t> answers = ask(accel, points, Isa::scalar);
  Column<float> columns[3];
  for (const Vec3f& p : points)
    for (int k = 0; k < 3; ++k) columns[k].push_back(p[k]);
  const PointSpan span{{columns[0].data(), columns[1].data(), columns[2].data()}, points.size()};
  for (const Isa isa : available_isas()) {
    EXPECT_EQ(ask(accel, points, isa), answers) << to_string(isa);
    std::vector<std::uint8_t> other(points.size(), 7);
    inside(accel, span, other, isa);
    EXPECT_EQ(other, answers) << to_string(isa);
    for (std::size_t i = 0; i < points.size(); i += 37)
      EXPECT_EQ(inside(accel, points[i], isa), answers[i] == 1) << to_string(isa);
  }
  return answers;
}

/// The geometry of a shape that is no mesh.
struct AsGeometry {
  Geometry operator()(const SphereShape& s) const { return {SpheresShape{{s}}, {}, kNoId}; }
  Geometry operator()(const PlaneShape& s) const { return {s, {}, kNoId}; }
  Geometry operator()(const BoxShape& s) const { return {s, {}, kNoId}; }
  Geometry operator()(const ExactShape& s) const { return {s, {}, kNoId}; }
  template <class T>
  Geometry operator()(const T&) const {
    std::abort();
  }
};

/// A geometry under `m`, as it stands or as an instance of one of two sorts.
std::shared_ptr<const Accel> placed(Geometry g, const Affine& m, std::uint64_t how) {
  if (how % 3 == 0) {
    g.transform = m;
    return build_accel({g});
  }
  const auto child = build_accel({g});
  if (how % 3 == 1) return build_accel({{InstanceGeometry{child}, m, kNoId}});
  InstanceList list{{child}, {{{}, 0, kNoId}}};
  m.to_rows(list.places[0].to_list);
  return build_accel({{list, {}, kNoId}});
}

/// Points in and around the box of a known shape under `m`: right answers count, those within a few roundings
/// of the boundary are left out.
void check_known(const KnownShape& known, const Affine& m, std::uint64_t how, int count, CaseRandom& random,
                 std::uint64_t& asked, std::uint64_t& doubtful) {
  const auto accel = placed(std::visit(AsGeometry{}, known.shape), m, how);
  const Vec3d extent = known.truth.hi - known.truth.lo;
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i) {
    const Vec3d unit{random.unit(), random.unit(), random.unit()};
    points.push_back(Vec3f(m.point(known.truth.lo + extent * (unit * 1.2 - Vec3d{0.1, 0.1, 0.1}))));
  }
  const std::vector<std::uint8_t> answers = ask(*accel, points);
  double size = std::max(max_component(abs(known.truth.lo)), max_component(abs(known.truth.hi)));
  // The floats of a listed instance, and of the point inside.
  for (const auto& row : m.m) size = std::max(size, std::abs(row[3]) / m.uniform_scale());
  const long double margin = size * 0x1p-20L;
  const Affine inverse = m.inverse();
  for (int i = 0; i < count; ++i) {
    const Vec3l p = mapped(inverse, Vec3l(points[static_cast<std::size_t>(i)]));
    const bool expected = known.truth.f(p) < 0;
    ++asked;
    if ((answers[static_cast<std::size_t>(i)] == 1) == expected) continue;
    bool near = false;
    for (int axis = 0; axis < 3; ++axis)
      for (const long double side : {-margin, margin}) {
        Vec3l q = p;
        q[axis] += side;
        near |= (known.truth.f(q) < 0) != expected;
      }
    ASSERT_TRUE(near) << "point " << i << " should be " << (expected ? "inside" : "outside");
    ++doubtful;
  }
}

/// Kinds whose shapes enclose nothing, and meshes, which have a test of their own below.
const std::set<std::string> kNoSolids{"cylinder_open",
                                      "cone_open",
                                      "polynomial_barth",
                                      "bezier_patch",
                                      "bezier_patch_cap",
                                      "parametric",
                                      "parametric_cap",
                                      "heightfield",
                                      "heightfield_triangles",
                                      "heightfield_nearest",
                                      "spheres",
                                      "disk",
                                      "polygon",
                                      "triangle",
                                      "closed_mesh",
                                      "triangle_soup"};

std::vector<std::string> kinds_of_solids() {
  std::vector<std::string> kinds;
  for (const std::string& kind : known_kinds())
    if (!kNoSolids.contains(kind)) kinds.push_back(kind);
  return kinds;
}

// Every solid that a scene can hold, against its equation in extended precision.
class InsideOfKind : public testing::TestWithParam<std::string> {};

TEST_P(InsideOfKind, AgreesWithTheEquation) {
  const auto kind =
      static_cast<std::size_t>(std::ranges::find(known_kinds(), GetParam()) - known_kinds().begin());
  std::uint64_t asked = 0, doubtful = 0;
  const int points = effort() == 1 ? 60 : 1000;
  for (std::uint64_t number = 0; number < static_cast<std::uint64_t>(8 * effort()); ++number) {
    const KnownShape known = draw_known_shape(kind, number);
    if (!known.is_solid()) continue;
    CaseRandom random(number * 1000 + kind);
    const double scale = random.magnitude(-2, 2);
    const Affine m = Affine::translation(random.vector() * (3 * scale)) *
                     Affine::rotation(random.vector() * 180.0) * Affine::scaling({scale, scale, -scale});
    check_known(known, number % 4 == 0 ? Affine{} : m, number, points, random, asked, doubtful);
    if (HasFatalFailure()) FAIL() << GetParam() << "." << number;
  }
  EXPECT_GT(asked, 0u);
  EXPECT_LE(doubtful * 1000, asked);
  if (effort() > 1)
    std::printf("%s: %llu points, %llu within rounding of the boundary\n", GetParam().c_str(),
                static_cast<unsigned long long>(asked), static_cast<unsigned long long>(doubtful));
}

INSTANTIATE_TEST_SUITE_P(Kinds, InsideOfKind, testing::ValuesIn(kinds_of_solids()),
                         [](const auto& kind) { return kind.param; });

// Points anywhere, and points from which the ray runs exactly, or nearly so, through corners and edges.
TEST(Inside, OfClosedMeshesByWhereTheyWindAround) {
  for (const OracleMesh& m : {make_cube(), make_icosphere(1), make_icosphere(3), make_torus(24, 12),
                              make_globe(30, 10), make_needles(40)}) {
    const TriangleMesh& mesh = m.mesh;
    const auto accel = build_accel({{MeshGeometry{&mesh}, {}, kNoId}});
    const auto split = build_accel({{MeshGeometry{&mesh}, {}, kNoId}}, {.quality = BuildQuality::best});
    CaseRandom random(5);
    const Box box = bounds(*accel);
    std::vector<Vec3f> points;
    for (int i = 0; i < 300 * effort(); ++i) {
      const Vec3d unit{random.unit(), random.unit(), random.unit()};
      points.push_back(Vec3f(Vec3d(box.lo) + Vec3d(box.extent()) * unit));
      const Vec3f direction{0.4142f, 0.2718f, 0.8686f};
      const std::size_t t = 3 * (random.bits() % mesh.triangle_count());
      const Vec3f a = mesh.positions[mesh.indices[t]], b = mesh.positions[mesh.indices[t + 1]];
      const float away = static_cast<float>(random.unit());
      points.push_back(a - direction * away);
      points.push_back((a + b) * 0.5f - direction * away);
      // From lattice points, rays of many meshes meet lattice lines.
      points.push_back(
          {std::floor(points[points.size() - 3].x * 4) / 4, std::floor(points.back().y * 4) / 4, 0.25f});
    }
    const std::vector<std::uint8_t> answers = ask(*accel, points);
    EXPECT_EQ(ask(*split, points), answers);
    std::size_t checked = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3d p(points[i]);
      if (near_surface(mesh, p, 1e-6)) continue;
      ASSERT_EQ(answers[i], std::abs(winding_number(mesh, p)) > 0.5 ? 1 : 0) << m.name << ", point " << i;
      ++checked;
    }
    EXPECT_GT(checked, points.size() / 2) << m.name;
  }
}

// Solids that overlap are one; a mesh may be wound either way and be mirrored.
TEST(Inside, OfTheUnionOfAllSolids) {
  const TriangleMesh ball = make_icosphere(2).mesh;
  TriangleMesh turned = ball;
  for (std::size_t i = 0; i < turned.indices.size(); i += 3)
    std::swap(turned.indices[i], turned.indices[i + 1]);
  const auto at = [](double x) { return Affine::translation({x, 0, 0}); };
  const auto child =
      build_accel({{MeshGeometry{&ball}, {}, kNoId}, {SpheresShape{{{{0, 0, 5}, 1}}}, {}, kNoId}});
  std::vector<Geometry> things;
  things.push_back({MeshGeometry{&ball}, at(0), kNoId});
  things.push_back({MeshGeometry{&turned}, at(1), kNoId});
  things.push_back({InstanceGeometry{child}, at(2) * Affine::scaling({-1, 1, 1}), kNoId});
  things.push_back({InstanceGeometry{child}, at(2), kNoId});
  things.push_back({SpheresShape{{{{3, 0, 0}, 1}, {{3.5, 0, 0}, 1}, {{3, 0, 0}, 0.5}}}, {}, kNoId});
  things.push_back({DiskShape{{-3, 0, 0}, {1, 0, 0}, 1}, {}, kNoId});
  things.push_back({PolygonShape{{{-3, -1, 3}, {-2, -1, 3}, {-2, 1, 3}}}, {}, kNoId});
  things.push_back(
      {ExactShape{CylinderShape{.from = {-3, 0, -1}, .to = {-3, 0, 1}, .open = true}}, {}, kNoId});
  const auto accel = build_accel(things);
  const std::vector<Vec3f> in{{0, 0, 0},    {0.5f, 0, 0}, {1.5f, 0, 0}, {2, 0, 0}, {2.5f, 0, 0.1f},
                              {3.2f, 0, 0}, {3, 0, 0.4f}, {4.4f, 0, 0}, {2, 0, 5}, {2.1f, 0.2f, 4.6f}};
  const std::vector<Vec3f> out{{-3, 0, 0}, {-3, 0, -0.5f},   {-1.5f, 0, 0}, {5, 0, 0}, {0, 0, 5},
                               {2, 0, 3},  {-2.5f, 0, 2.9f}, {2, 0, 6.5f},  {0, 2, 0}};
  for (const std::uint8_t answer : ask(*accel, in)) EXPECT_EQ(answer, 1);
  for (const std::uint8_t answer : ask(*accel, out)) EXPECT_EQ(answer, 0);
}

// The half-space behind a plane is inside, alone, in an instance and in combinations; so is the rest of space
// of a difference.
TEST(Inside, OfWhatHasNoBounds) {
  const Geometry ground{PlaneShape{{0, 1, 0}, 0}, {}, kNoId};
  const auto child = build_accel({ground});
  const auto hole = std::make_shared<CsgExpression>();
  hole->op = CsgOp::subtract;
  hole->children.resize(2);
  hole->children[0].solids = {ground};
  hole->children[1].solids = {{SpheresShape{{{{0, 0, 0}, 2}}}, {}, kNoId}};
  const Affine raise = Affine::translation({0, 10, 0});
  const auto plane = build_accel({ground}), instance = build_accel({{InstanceGeometry{child}, raise, kNoId}});
  const auto carved = build_accel({{CsgGeometry{hole}, {}, kNoId}});
  const auto carved_child = build_accel({{InstanceGeometry{carved}, raise, kNoId}});
  CaseRandom random(3);
  for (int i = 0; i < 1000; ++i) {
    const Vec3f p = Vec3f(random.vector() * random.magnitude(-1, 4));
    const auto in_carved = [](const Vec3f& q) { return q.y < 0 && length(q) > 2; };
    ASSERT_EQ(inside(*plane, p), p.y < 0);
    ASSERT_EQ(inside(*instance, p), p.y < 10);
    ASSERT_EQ(inside(*carved, p), in_carved(p)) << p.x << " " << p.y << " " << p.z;
    ASSERT_EQ(inside(*carved_child, p + Vec3f{0, 10, 0}), in_carved((p + Vec3f{0, 10, 0}) - Vec3f{0, 10, 0}));
  }
}

TEST(Inside, NothingElse) {
  const auto accel = build_accel({{SpheresShape{{{{0, 0, 0}, 1}}}, {}, kNoId}, {PlaneShape{}, {}, kNoId}});
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const Vec3f& p : {Vec3f{nan, 0, 0}, Vec3f{0, -inf, 0}, Vec3f{inf, inf, inf}}) {
    EXPECT_FALSE(inside(*accel, p));
    EXPECT_EQ(signed_distance(*accel, p), inf);
  }
  EXPECT_FALSE(inside(*build_accel({}), {0, 0, 0}));
  std::vector<Vec3f> points(2);
  std::vector<std::uint8_t> answers(3);
  EXPECT_THROW(inside(*accel, points, answers), Error);
}

// Against closed forms; the sign is that of inside().
TEST(SignedDistance, OfClosedForms) {
  const auto sphere = build_accel({{SpheresShape{{{{1, 2, 3}, 2}}}, {}, kNoId}});
  const auto box = build_accel({{BoxShape{{-1, -2, -3}, {1, 2, 3}}, {}, kNoId}});
  const auto torus = build_accel({{ExactShape{TorusShape{2, 0.5}}, {}, kNoId}});
  CaseRandom random(8);
  for (int i = 0; i < 2000; ++i) {
    const Vec3f p = Vec3f(random.vector() * 5.0);
    const Vec3d q(p);
    EXPECT_NEAR(signed_distance(*sphere, p), length(q - Vec3d{1, 2, 3}) - 2, 1e-6);
    const Vec3d d = abs(q) - Vec3d{1, 2, 3};
    EXPECT_NEAR(signed_distance(*box, p), length(max(d, Vec3d{0, 0, 0})) + std::min(max_component(d), 0.0),
                1e-6);
    const double ring = std::sqrt(q.x * q.x + q.y * q.y) - 2;
    EXPECT_NEAR(signed_distance(*torus, p), std::sqrt(ring * ring + q.z * q.z) - 0.5, 1e-6);
  }
}

}  // namespace
}  // namespace oktett::inside_test
