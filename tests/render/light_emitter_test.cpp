#include "render/light/emitter.h"

#include <gtest/gtest.h>
#include <numbers>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/render/light_checks.h"

namespace oktett::light_emitter_test {
namespace {

using namespace light_checks;

constexpr Color kWhite{1, 1, 1};

ParametricSurface surface_of(const TriangleEmitter& e) {
  const Vec3d a(e.a), u = Vec3d(e.b) - a, v = Vec3d(e.c) - a;
  return {[=](double x, double y) { return a + (u * (1 - y) + v * y) * x; },
          [=](double x, double) { return cross(u, v) * x; },
          [](const LightSample& s, const Vec3f&) {
            const double sum = double{s.u} + s.v;
            return SquareSample{sum, sum > 0 ? s.v / sum : 0};
          }};
}

ParametricSurface surface_of(const RectangleEmitter& e) {
  const Vec3d a(e.corner), u(e.edge_u), v(e.edge_v);
  return {[=](double x, double y) { return a + u * x + v * y; }, [=](double, double) { return cross(u, v); },
          [](const LightSample& s, const Vec3f&) {
            return SquareSample{s.u, s.v};
          }};
}

Vec3d place_of(const LightSample& s, const Vec3f& p) {
  return Vec3d(p) + Vec3d(s.direction) * double{s.distance};
}

double turn_of(double y, double x) {
  const double turn = std::atan2(y, x) / (2 * std::numbers::pi);
  return turn < 0 ? turn + 1 : turn;
}

ParametricSurface surface_of(const DiskEmitter& e) {
  const Vec3d c(e.center), n = normalize(Vec3d(e.normal));
  const Vec3d t = normalize(cross(n, std::abs(n.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0})), b = cross(n, t);
  const double r = e.radius;
  return {[=](double x, double y) {
            return c + (t * std::cos(2 * std::numbers::pi * y) + b * std::sin(2 * std::numbers::pi * y)) *
                           (r * x);
          },
          [=](double x, double) { return n * (2 * std::numbers::pi * r * r * x); },
          [=](const LightSample& s, const Vec3f& p) {
            const Vec3d d = place_of(s, p) - c;
            return SquareSample{length(d) / r, turn_of(dot(d, b), dot(d, t))};
          }};
}

ParametricSurface surface_of(const SphereEmitter& e) {
  const Vec3d c(e.center);
  const double r = e.radius;
  const auto direction = [](double x, double y) {
    const double z = 1 - 2 * x, s = std::sqrt(1 - z * z);
    return Vec3d{s * std::cos(2 * std::numbers::pi * y), s * std::sin(2 * std::numbers::pi * y), z};
  };
  return {[=](double x, double y) { return c + direction(x, y) * r; },
          [=](double x, double y) { return direction(x, y) * (4 * std::numbers::pi * r * r); },
          [=](const LightSample& s, const Vec3f& p) {
            const Vec3d d = (place_of(s, p) - c) / r;
            return SquareSample{(1 - d.z) / 2, turn_of(d.y, d.x)};
          }};
}

/// Whether a sphere hides this part of itself.
bool hidden(const Emitter& emitter, const Vec3f& point, const Patch& patch) {
  const auto* e = std::get_if<SphereEmitter>(&emitter);
  if (!e) return false;
  const bool outside = length(Vec3d(e->center) - Vec3d(point)) >= e->radius;
  return outside && dot(patch.normal, patch.direction) > 0;
}

struct Case {
  std::string name;
  Emitter emitter;
  Vec3f point;
  bool by_place = true;  ///< samples are exact enough to say where on the emitter they are
};

ParametricSurface surface_of(const Case& c) {
  if (const auto* e = std::get_if<TriangleEmitter>(&c.emitter)) return surface_of(*e);
  if (const auto* e = std::get_if<RectangleEmitter>(&c.emitter)) return surface_of(*e);
  if (const auto* e = std::get_if<DiskEmitter>(&c.emitter)) return surface_of(*e);
  return surface_of(std::get<SphereEmitter>(c.emitter));
}

std::vector<Case> cases() {
  const TriangleEmitter triangle{{0, 0, 0}, {2, 0.2f, 0}, {0.3f, 1.5f, 0}, kWhite, true};
  const TriangleEmitter tilted{{1, 2, 3}, {1.5f, 2, 4}, {0.5f, 3, 3.5f}, kWhite, true};
  const TriangleEmitter sliver{{-5, 0, 0}, {5, 0, 0}, {0, 0.01f, 0}, kWhite, true};
  const RectangleEmitter square{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, kWhite, true};
  const RectangleEmitter turned{{1, 2, 3}, {0.5f, 0.5f, 0}, {-1, 1, 0}, kWhite, true};
  const RectangleEmitter strip{{-10, 0, 0}, {20, 0, 0}, {0, 0.05f, 0}, kWhite, true};
  const RectangleEmitter skewed{{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, kWhite, true};
  const DiskEmitter disk{{0.5f, 0, 1}, normalize(Vec3f{1, 2, -2}), 0.75f, kWhite, true};
  const SphereEmitter ball{{1, 2, 3}, 0.5f, kWhite, true};
  const SphereEmitter huge{{0, 0, -1e4f}, 1e4f, kWhite, true};
  return {
      {"triangle", triangle, {0.7f, 0.5f, 1}},
      {"triangle from behind", triangle, {0.7f, 0.5f, -1}},
      {"triangle from beside", triangle, {3, -2, 0.5f}},
      {"triangle grazing", triangle, {4, 1, 0.01f}},
      {"triangle near", triangle, {0.7f, 0.5f, 1e-3f}},
      {"triangle near an edge", triangle, {1, 0.099f, 1e-3f}},
      {"triangle near a corner", triangle, {0.002f, 0.001f, 1e-3f}},
      {"triangle far", triangle, {300, 200, 500}, true},
      {"triangle very far", triangle, {30000, 20000, 50000}, true},
      {"tilted triangle", tilted, {0, 0, 0}},
      {"sliver", sliver, {0.2f, 0.3f, 0.2f}},
      {"sliver near", sliver, {0.2f, 0.01f, 0.01f}},
      {"square", square, {0.3f, 0.4f, 1}},
      {"square from behind", square, {0.3f, 0.4f, -2}},
      {"square from beside", square, {3, 2, 0.5f}},
      {"square grazing", square, {4, 1, 0.01f}},
      {"square near", square, {0.3f, -0.4f, 1e-3f}},
      {"square near an edge", square, {1, 0.5f, 1e-3f}},
      {"square far", square, {300, 200, 500}},
      {"square very far", square, {30000, 20000, 50000}},
      {"turned rectangle", turned, {0, 0, 0}},
      {"strip", strip, {0.2f, 0.3f, 0.2f}},
      {"strip near", strip, {-3, 0.01f, 0.01f}},
      {"skewed", skewed, {0.3f, 0.4f, 1}},
      {"disk", disk, {0, 0, 0}},
      {"disk from behind", disk, {1, 2, -1}},
      {"disk grazing", disk, {3, -1, 1.3f}},
      {"disk near", disk, Vec3f{0.7f, 0, 1.1f} - normalize(Vec3f{1, 2, -2}) * 0.01f},
      {"disk very near", DiskEmitter{{0, 0, 0}, {0, 0, 1}, 10, kWhite, true}, {3, 2, 1e-3f}},
      {"disk near its rim", DiskEmitter{{0, 0, 0}, {0, 0, 1}, 1, kWhite, true}, {0, 0.98f, -0.01f}},
      {"disk far", disk, {300, 200, -500}, false},
      {"ball", ball, {0, 0, 0}},
      {"ball near", ball, {1, 2.501f, 3}},
      {"ball far", ball, {-100, 50, 10}, false},
      {"ball very far", ball, {-1e5f, 5e4f, 1e4f}, false},
      {"ball from inside", ball, {1.1f, 2.2f, 2.9f}},
      {"ball from inside near its surface", ball, {1, 2.495f, 3}},
      {"ball from its centre", ball, {1, 2, 3}},
      {"huge ball", huge, {0, 0, 100}, false},
  };
}

std::string with(const Case& c) { return "case: " + c.name; }

// The pdf, integrated over the solid angle of the emitter by quadrature, is 1; samples fall where the pdf
// says, judged by cells of the emitter and by cells of all directions.
TEST(LightEmitter, SamplesHaveTheDensityThatPdfSays) {
  constexpr int kCells = 8, kFaces = 6;
  constexpr int kSamples = 20000;
  std::uint64_t key = 0;
  for (const Case& c : cases()) {
    SCOPED_TRACE(with(c));
    const LightPoint point{c.point, {}};
    const ParametricSurface surface = surface_of(c);
    std::vector<double> place(kCells * kCells), direction(6 * kFaces * kFaces);
    double integral = 0;
    const auto cell_of = [](double u, double v) {
      const auto cell = [](double x) { return std::clamp(static_cast<int>(x * kCells), 0, kCells - 1); };
      return static_cast<std::size_t>(cell(u) * kCells + cell(v));
    };
    cut(surface, Vec3d(c.point), 0, 1, 0, 1, 0, [&](const Patch& p) {
      if (hidden(c.emitter, c.point, p)) return;
      const double mass = emitter_pdf(c.emitter, point, Vec3f(p.direction), static_cast<float>(p.distance)) *
                          p.solid_angle * kSamples;
      integral += mass / kSamples;
      place[cell_of(p.u, p.v)] += mass;
      direction[cube_cell(p.direction, kFaces)] += mass;
    });
    EXPECT_NEAR(integral, 1, 2e-3);

    Random random(++key);
    std::vector<double> placed(place.size()), directed(direction.size());
    for (int i = 0; i < kSamples; ++i) {
      const auto s = sample_emitter(c.emitter, point, random.square());
      ASSERT_TRUE(s);
      ASSERT_NEAR(length(s->direction), 1, 1e-6f);
      ASSERT_TRUE(std::isfinite(s->distance) && s->distance > 0 && s->pdf > 0 && std::isfinite(s->pdf));
      ASSERT_EQ(s->radiance, kWhite);
      ASSERT_FALSE(s->delta);
      const float pdf = emitter_pdf(c.emitter, point, s->direction, s->distance);
      ASSERT_NEAR(pdf / s->pdf, 1, 2e-3f);
      const SquareSample at = surface.inverse(*s, c.point);
      ++placed[cell_of(at.x, at.y)];
      ++directed[cube_cell(Vec3d(s->direction), kFaces)];
      if (!c.by_place) continue;
      ASSERT_LT(length(surface.position(at.x, at.y) - place_of(*s, c.point)), 1e-6 * (10 + s->distance));
    }
    if (c.by_place) {
      EXPECT_LT(chi_squared(place, placed), 4);
    }
    // The quadrature may put a patch into the cell beside the right one.
    for (double& d : direction) d = std::max(d, 1e-9);
    EXPECT_LT(chi_squared(direction, directed), 4);
  }
}

TEST(LightEmitter, FrontOnlyEmittersAreDarkBehind) {
  const std::vector<Emitter> front = {
      TriangleEmitter{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, kWhite},
      RectangleEmitter{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, kWhite},
      DiskEmitter{{0, 0, 0}, {0, 0, 1}, 1, kWhite},
      SphereEmitter{{0, 0, -2}, 1.5f, kWhite},
  };
  for (const Emitter& e : front) {
    const Vec3f towards{0, 0, -1};
    EXPECT_TRUE(sample_emitter(e, {{0.2f, 0.2f, 1}, {}}, {0.3, 0.6}));
    EXPECT_GT(emitter_pdf(e, {{0.2f, 0.2f, 1}, {}}, towards, 1), 0);
    EXPECT_FALSE(sample_emitter(e, {{0.2f, 0.2f, -1}, {}}, {0.3, 0.6}));
    EXPECT_EQ(emitter_pdf(e, {{0.2f, 0.2f, -1}, {}}, towards * -1.0f, 1), 0);
  }
}

// A point in the plane of a flat emitter, even on it, sees nothing of it.
TEST(LightEmitter, PointsInThePlaneAreNotLit) {
  const std::vector<Emitter> flat = {TriangleEmitter{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, kWhite, true},
                                     RectangleEmitter{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, kWhite, true},
                                     DiskEmitter{{0, 0, 0}, {0, 0, 1}, 1, kWhite, true}};
  for (const Emitter& e : flat)
    for (const Vec3f& p : {Vec3f{0, 0, 0}, Vec3f{0.25f, 0.25f, 0}, Vec3f{0.5f, 0, 0}, Vec3f{3, 2, 0}}) {
      EXPECT_FALSE(sample_emitter(e, {p, {0, 0, 1}}, {0.3, 0.6}));
      EXPECT_EQ(emitter_pdf(e, {p, {0, 0, 1}}, {1, 0, 0}, 1), 0);
    }
}

// Whatever the numbers are, samples are usable or there are none.
TEST(LightEmitter, ExtremeSizesGiveNoNan) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  Random random(11);
  for (const float size : {0.0f, 1e-40f, 1e-30f, 1e-20f, 1e-8f, 1.0f, 1e8f, 1e18f, 1e30f, inf, nan})
    for (const float height : {0.0f, 1e-30f, 1e-8f, 1.0f, 1e8f, 1e18f}) {
      const std::vector<Emitter> all = {
          TriangleEmitter{{0, 0, height}, {size, 0, height}, {0, size, height}, kWhite, true},
          RectangleEmitter{{0, 0, height}, {size, 0, 0}, {0, size, 0}, kWhite, true},
          DiskEmitter{{0, 0, height}, {0, 0, 1}, size, kWhite, true},
          SphereEmitter{{0, 0, height}, size, kWhite, true},
          PointEmitter{{0, 0, height}, Color{size, size, size}},
          SpotEmitter{{0, 0, height}, {0, 0, -1}, Color{size, size, size}, 0.9f, 0.5f}};
      for (const Emitter& e : all)
        for (int i = 0; i < 20; ++i) {
          const SquareSample u = i == 0   ? SquareSample{0, 0}
                                 : i == 1 ? SquareSample{1 - 0x1p-53, 1 - 0x1p-53}
                                          : random.square();
          const LightPoint point{i < 10 ? Vec3f{} : random.direction() * 0.1f, {}};
          if (const auto s = sample_emitter(e, point, u)) {
            ASSERT_TRUE(is_finite(s->direction) && is_finite(s->radiance))
                << size << " " << height << " " << e.index();
            ASSERT_NEAR(length(s->direction), 1, 1e-5f);
            ASSERT_TRUE(s->distance > 0 && s->pdf > 0 && std::isfinite(s->pdf));
          }
          const float pdf = emitter_pdf(e, point, {0, 0, 1}, 1);
          ASSERT_TRUE(pdf >= 0 && std::isfinite(pdf));
        }
      for (const Emitter& e : all) {
        const auto bounds = light_bounds(e);
        if (!(size > 0) || !std::isfinite(size)) {
          EXPECT_FALSE(bounds) << e.index();
        }
        if (bounds) {
          EXPECT_TRUE(bounds->power > 0 && is_finite(bounds->axis));
        }
      }
    }
}

}  // namespace
}  // namespace oktett::light_emitter_test
