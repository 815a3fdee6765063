/// \file Texture coordinates of all shapes: what they change by between neighbouring hits against dp/du and
/// dp/dv.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "core/random.h"
#include "render/geometry.h"
#include "verify/oracles/known_shapes.h"

namespace oktett::uv_test {
namespace {

/// The distance of neighbouring rays.
constexpr double kStep = 1e-3;

/// Rays from all around towards the place of a shape of size 1, in threes that lie close together.
RayBatch threes(const Affine& place, std::size_t kind, std::uint64_t number) {
  RayBatch rays;
  for (std::uint32_t i = 0; i < 200; ++i) {
    const auto random = [&](std::uint32_t k) {
      return 2 * static_cast<double>(random_float(static_cast<std::uint32_t>(77 + kind), i,
                                                  k + 16 * static_cast<std::uint32_t>(number))) -
             1;
    };
    const Vec3d from = normalize(Vec3d{random(0), random(1), random(2)}) * 4.0;
    const Vec3d d = Vec3d{random(3), random(4), random(5)} - from;
    Vec3d x, y;
    make_basis(normalize(d), x, y);
    for (const Vec3d& aside : {Vec3d{0, 0, 0}, x, y})
      rays.push_back({Vec3f(place.point(from + aside * kStep)), 0, Vec3f(place.vector(d))});
  }
  return rays;
}

/// Adds by how much a step between neighbouring hits differs from what uv tell, relative to the step.
void add_errors(const Accel& accel, const RayBatch& rays, std::vector<double>& errors) {
  for (std::size_t i = 0; i + 3 <= rays.size(); i += 3) {
    SurfaceInteraction s[3];
    bool hit = true;
    for (std::size_t k = 0; k < 3 && hit; ++k) {
      const Hit at = closest_hit(accel, rays[i + k]);
      hit = at.valid();
      if (hit) s[k] = surface_interaction(accel, rays[i + k], at);
    }
    if (!hit) continue;
    const Vec3d tangent(s[0].tangent), bitangent(s[0].bitangent);
    // Without coordinates, near a pole, or where one coordinate stays the same there is nothing to compare.
    if (!(length(cross(tangent, bitangent)) > 1e-2 * length(tangent) * length(bitangent))) continue;
    for (std::size_t k = 1; k < 3; ++k) {
      const double du = double(s[k].uv.x) - s[0].uv.x, dv = double(s[k].uv.y) - s[0].uv.y;
      const Vec3d step = Vec3d(s[k].position) - Vec3d(s[0].position);
      // Across an edge, a seam or to another part, and at grazing incidence.
      const bool same = s[k].primitive == s[0].primitive && length(step) < 0.02 &&
                        dot(s[k].geometric_normal, s[0].geometric_normal) > 0.999f;
      if (!same || std::abs(du) > 0.1 || std::abs(dv) > 0.1) continue;
      errors.push_back(length(tangent * du + bitangent * dv - step) / length(step));
    }
  }
}

class UvOfKind : public testing::TestWithParam<std::size_t> {};

TEST_P(UvOfKind, TangentsTellHowThePlaceChanges) {
  // Also mirrored, and stretched where shapes are not stretched by instances.
  const Affine places[] = {Affine::rotation({30, 40, 50}),
                           Affine::rotation({-70, 20, 10}) * Affine::scaling({1.2, 1.2, -1.2}),
                           Affine::rotation({5, 100, 3}) * Affine::scaling({0.7, 1.4, 1})};
  std::vector<double> errors;
  std::size_t with_uv = 0;
  for (std::uint64_t number = 0; number < 12; ++number) {
    Scene scene;
    Object& object = scene.objects.emplace_back();
    object.shape = draw_known_shape(GetParam(), number).shape;
    object.transform = places[number % 3];
    const World world = build_world(scene);
    const std::size_t before = errors.size();
    add_errors(*world.accel, threes(object.transform, GetParam(), number), errors);
    with_uv += errors.size() > before;
  }
  const std::string& kind = known_kinds()[GetParam()];
  if (with_uv == 0) {
    // Those that the documents list as having none.
    const std::vector<std::string> none = {"implicit", "polynomial",  "blob",          "julia",
                                           "triangle", "closed_mesh", "triangle_soup", "sphere_sweep"};
    EXPECT_TRUE(std::ranges::any_of(none, [&](const std::string& name) { return kind.starts_with(name); }))
        << kind;
    return;
  }
  std::ranges::sort(errors);
  ASSERT_GE(errors.size(), 50u) << kind;
  EXPECT_LT(errors[errors.size() / 2], 0.01) << kind;
  EXPECT_LT(errors[errors.size() * 95 / 100], 0.1) << kind;
}

INSTANTIATE_TEST_SUITE_P(Shapes, UvOfKind, testing::Range(std::size_t{0}, known_kinds().size()),
                         [](const auto& shape) { return known_kinds()[shape.param]; });

}  // namespace
}  // namespace oktett::uv_test
