/// \file The filters of closed-form and exact shapes in beams: every ray has the same bits as alone by the
/// scalar path, also rays along silhouettes, from far away, and from the surface itself. That beams hit what
/// oracles say is tested by TraceModes.NearestHitsAreThoseOfTheOracles and, for exact surfaces, by
/// Exact.AgreesWithItsOracle.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/accel/same_hits.h"
#include "tests/support/dice.h"

namespace oktett::beam_shapes_test {
namespace {

/// A shape of about the size 1 about the origin.
Geometry make_shape(int which, Dice<double>& dice) {
  Geometry g;
  const bool open = dice.below(3) == 0;
  switch (which) {
    case 0:
      g.shape = SpheresShape{{{dice.vec(0.5), dice.range(0.01, 0.5)}, {dice.vec(0.5), dice.range(0.1, 0.6)}}};
      break;
    case 1: {
      const double minor = dice.range(0.02, 0.6);
      g.shape = ExactShape{TorusShape{dice.range(0.3, 0.7), minor}};
      break;
    }
    case 2:
      g.shape = ExactShape{CylinderShape{dice.vec(0.3), dice.vec(0.9), dice.range(0.05, 0.8), open}};
      break;
    case 3:
      g.shape = ExactShape{ConeShape{
          {0, -0.7, 0}, {0.1, 0.7, 0}, dice.below(2) * dice.range(0.1, 0.9), dice.range(0, 0.9), open}};
      break;
    case 4: {
      QuadricShape q;
      for (double& c : q.coefficients) c = dice.below(3) == 0 ? 0 : dice.range(-1, 1);
      q.coefficients[9] = dice.range(-0.3, 0.1);
      q.clipped = true, q.open = open;
      g.shape = ExactShape{q};
      break;
    }
    case 5: {
      RevolutionShape r;
      const int profile = dice.below(3);
      r.profile = profile == 0   ? RevolutionShape::Profile::spline
                  : profile == 1 ? RevolutionShape::Profile::linear
                                 : RevolutionShape::Profile::sor;
      double height = -1.2;
      for (int k = 0; k < 6; ++k) {
        r.points.push_back({dice.range(0.3, 0.8), height});
        if (!(profile == 1 && dice.below(3) == 0)) height += dice.range(0.3, 0.5);
      }
      r.open = open;
      g.shape = ExactShape{r};
      break;
    }
    default:
      g.shape = PlaneShape{dice.vec(1), dice.range(-0.5, 0.5)};
  }
  return g;
}

struct Subject {
  std::shared_ptr<const Accel> accel;
  Vec3d center;
  double scale;
};

/// A few shapes of one kind, the first of them at the centre, in one of several sizes and places.
Subject make_subject(int which, Dice<double>& dice) {
  Subject s;
  s.scale = std::exp2(dice.below(3) == 0 ? dice.range(-25, 25) : 0);
  s.center = dice.vec(dice.below(3) == 0 ? 1000 : 1) * s.scale;
  std::vector<Geometry> all;
  for (int k = 0; k < 3; ++k) {
    const Vec3d at = k == 0 ? Vec3d{0, 0, 0} : dice.vec(2);
    const Vec3d stretch = dice.below(2) == 0
                              ? Vec3d{1, 1, 1}
                              : Vec3d{dice.range(0.2, 1), dice.range(0.2, 1), dice.range(0.2, 1)};
    Geometry g = make_shape(which, dice);
    // Spheres and planes stay what they are under motions and uniform scaling only.
    g.transform = Affine::translation(s.center + at * s.scale) *
                  Affine::scaling((which == 0 || which == 6 ? Vec3d{1, 1, 1} : stretch) * s.scale) *
                  Affine::rotation(dice.vec(180));
    all.push_back(std::move(g));
  }
  s.accel = build_accel(std::move(all), {});
  return s;
}

bool hits(const Subject& s, const Vec3f& from, const Vec3f& to) {
  return closest_hit(*s.accel, Ray{from, 0, to - from}, Isa::scalar).valid();
}

/// A target at the silhouette: between one ray that hits and one that misses.
Vec3d silhouette(const Subject& s, const Vec3f& from, Dice<double>& dice) {
  Vec3d in = s.center + dice.vec(1) * s.scale, out = in;
  const bool first = hits(s, from, Vec3f(in));
  for (int k = 0; k < 20 && hits(s, from, Vec3f(out)) == first; ++k) out = s.center + dice.vec(1.5) * s.scale;
  for (int k = 0; k < 40; ++k) {
    const Vec3d middle = (in + out) * 0.5;
    (hits(s, from, Vec3f(middle)) == first ? in : out) = middle;
  }
  return in;
}

Vec3f random_apex(const Subject& s, Dice<double>& dice) {
  const double far[] = {0.5, 3, 10, 100, 3000};
  return Vec3f(s.center + dice.vec(far[dice.below(5)]) * s.scale);
}

class BeamShapes : public testing::TestWithParam<int> {};

constexpr int kRounds = 150;

TEST_P(BeamShapes, CommonOrigin) {
  Dice<double> dice(5 + static_cast<std::uint32_t>(GetParam()));
  for (int round = 0; round < kRounds; ++round) {
    const Subject s = make_subject(GetParam(), dice);
    const Vec3f from = random_apex(s, dice);
    const bool edge = dice.below(2) == 0;
    const Vec3d target = edge ? silhouette(s, from, dice) : s.center;
    const double wide = (edge ? std::exp2(dice.range(-30, -3)) : 1.5) * s.scale;
    const int ends = dice.below(3);
    RayBatch rays;
    for (int i = 0; i < 512; ++i) {
      Ray r{from, 0, Vec3f(target + dice.vec(wide)) - from};
      if (ends == 1) r.tmax = static_cast<float>(dice.range(0.8, 1.2));
      if (ends == 2) r.tmin = static_cast<float>(dice.range(0.8, 1.2));
      rays.push_back(r);
    }
    expect_hits(*s.accel, rays, scalar_hits(*s.accel, rays), {TraceMode::single, TraceMode::beam},
                "round " + std::to_string(round));
    if (HasFailure()) return;
  }
}

// From surfaces to a light, as shadow rays: from the rounded point itself, which may be on either side, and
// from beyond its error.
TEST_P(BeamShapes, FromSurfacesToAnEnd) {
  Dice<double> dice(77 + static_cast<std::uint32_t>(GetParam()));
  for (int round = 0; round < kRounds; ++round) {
    const Subject s = make_subject(GetParam(), dice);
    const Vec3f eye = random_apex(s, dice), light = random_apex(s, dice);
    const bool offset = dice.below(2) == 0, unit = dice.below(2) == 0;
    const Vec3d target = dice.below(2) == 0 ? silhouette(s, light, dice) : s.center;
    const double wide = std::exp2(dice.range(-12, 1)) * s.scale;
    RayBatch rays;
    for (int i = 0; i < 512; ++i) {
      const Ray seen{eye, 0, Vec3f(target + dice.vec(wide)) - eye};
      const Hit hit = closest_hit(*s.accel, seen, Isa::scalar);
      Vec3f from = Vec3f(target + dice.vec(wide));
      if (hit.valid()) {
        const SurfaceInteraction at = surface_interaction(*s.accel, seen, hit);
        from = offset ? offset_origin(at, light - at.position) : at.position;
      }
      const Vec3f to = light - from;
      rays.push_back(unit ? Ray{from, 0, normalize(to), length(to)} : Ray{from, 0, to, 1 - 0x1p-24f});
    }
    expect_hits(*s.accel, rays, scalar_hits(*s.accel, rays), {TraceMode::single, TraceMode::beam},
                "round " + std::to_string(round));
    if (HasFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, BeamShapes, testing::Range(0, 7));

}  // namespace
}  // namespace oktett::beam_shapes_test
