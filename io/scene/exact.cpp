#include "io/scene/exact.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kernels/exact/bezier_patch.h"
#include "kernels/exact/lathe.h"
#include "kernels/exact/parametric.h"
#include "kernels/exact/polyhedron.h"
#include "kernels/exact/prism.h"
#include "kernels/exact/revolution.h"
#include "kernels/exact/sphere_sweep.h"
#include "kernels/exact/superquadric.h"
#include "kernels/fractals/julia.h"
#include "kernels/fractals/terrain.h"

namespace oktett {
namespace {

using MaybeForm = std::optional<ExactForm>;
using ProfileKind = TurnedProfile::Kind;

/// Whether point `i` of a profile lies on the surface; the others only shape it.
bool is_on_surface(const TurnedProfile& profile, std::size_t i) {
  if (profile.kind == ProfileKind::linear) return true;
  if (profile.kind == ProfileKind::bezier) return i % 3 == 0;
  return i > 0 && i + 1 < profile.points.size();
}

/// Throws Error at `places`, those of the points, for a radius below 0 and for heights that do not ascend
/// where they must.
void check_points(const TurnedProfile& profile, std::span<const YamlNode* const> places) {
  const bool ascends = profile.kind != ProfileKind::curve && profile.kind != ProfileKind::bezier;
  for (std::size_t i = 0; i < profile.points.size(); ++i) {
    const ProfilePoint& p = profile.points[i];
    if (is_on_surface(profile, i) && p.radius < 0)
      throw Error(places[i]->where(), "the profile crosses the axis: the radius is negative");
    if (!ascends || i == 0) continue;
    const double before = profile.points[i - 1].height;
    if (profile.kind == ProfileKind::linear ? p.height < before : p.height <= before)
      throw Error(places[i]->where(),
                  fmt::format("heights must ascend: {} comes after {}; for other profiles "
                              "there is 'profile: curve'",
                              p.height, before));
  }
}

}  // namespace

MaybeForm finish(const ShapeNode& at, PolyhedronShape& shape) {
  switch (intersect(shape.planes).kind) {
    case ConvexSolid::Kind::unbounded:
      throw Error(at.fields.require("planes").where(), "the planes do not bound a solid on all sides");
    case ConvexSolid::Kind::empty:
      return at.skip("there is nothing inside of all planes");
    case ConvexSolid::Kind::solid:
      break;
  }
  return shape;
}

MaybeForm finish(const ShapeNode& at, SuperquadricShape& shape) {
  if (const Vec3d far = Superquadric::reach(shape);
      shape.form == SuperquadricShape::Form::toroid && !std::isfinite(far.x + far.y + far.z))
    throw Error(at.key.where(),
                "the toroid has no end: a pseudo-power stays below what it would have to reach");
  return shape;
}

MaybeForm finish(const ShapeNode& at, TurnedProfile& profile) {
  const YamlNode& node = at.fields.require("points");
  const std::size_t n = profile.points.size();
  if (profile.kind == ProfileKind::bezier && n % 3 != 1)
    throw Error(node.where(), fmt::format("expected 4, 7, 10, … points, 3 more for each piece; found {}", n));
  check_points(profile, list_items(node, "points"));
  bool has_radius = false;
  for (std::size_t i = 0; i < n; ++i) has_radius |= is_on_surface(profile, i) && profile.points[i].radius > 0;
  if (!has_radius) return at.skip("all radii are zero");
  if (profile.kind == ProfileKind::curve || profile.kind == ProfileKind::bezier) {
    const LatheShape lathe{
        profile.kind == ProfileKind::curve ? curve_through(profile.points) : profile.points, profile.open};
    if (const std::string wrong = why_bad_profile(lathe); !wrong.empty()) throw Error(node.where(), wrong);
    return lathe;
  }
  if (!(profile.points.front().height < profile.points.back().height))
    return at.skip("all heights are the same");
  using Profile = RevolutionShape::Profile;
  const RevolutionShape shape{profile.points,
                              profile.kind == ProfileKind::linear ? Profile::linear
                              : profile.kind == ProfileKind::sor  ? Profile::sor
                                                                  : Profile::spline,
                              profile.open};
  if (const auto height = profile_crosses_axis(shape))
    throw Error(
        node.where(),
        fmt::format("the profile crosses the axis: at height {:.6g} the radius is negative", *height));
  return shape;
}

/// The shape, unless the surface has nothing to show of it.
template <class Surface, class Form>
static MaybeForm unless_empty(const ShapeNode& at, const Form& shape, const char* why) {
  typename Surface::Pool pool;
  Surface::add(pool, shape, {});
  if (pool.elements.empty()) return at.skip(why);
  return shape;
}

MaybeForm finish(const ShapeNode& at, PrismShape& shape) {
  using Curve = PrismShape::Curve;
  const auto places = list_items(at.fields.require("outlines"), "outlines");
  const std::size_t least = shape.curve == Curve::linear ? 3 : shape.curve == Curve::quadratic ? 3 : 4;
  for (std::size_t i = 0; i < shape.outlines.size(); ++i) {
    const std::size_t n = shape.outlines[i].size();
    if (shape.curve == Curve::bezier && n % 3 != 1)
      throw Error(places[i]->where(),
                  fmt::format("expected 4, 7, 10, … points, 3 more for each piece; found {}", n));
    if (n < least)
      throw Error(places[i]->where(), fmt::format("expected at least {} points, found {}", least, n));
  }
  return unless_empty<Prism>(at, shape, "the outlines surround nothing");
}

MaybeForm finish(const ShapeNode& at, SphereSweepShape& shape) {
  return unless_empty<SphereSweep>(at, shape, "all radii are zero");
}

MaybeForm finish(const ShapeNode& at, BezierPatchShape& shape) {
  return unless_empty<BezierPatch>(at, shape, "all control points are in one place");
}

MaybeForm finish(const ShapeNode& at, ParametricShape& shape) {
  return unless_empty<Parametric>(at, shape, "the functions give no points that could be seen");
}

MaybeForm finish(const ShapeNode& at, JuliaShape& shape) {
  if (is_empty(shape)) return at.skip("nothing of the set is in this slice");
  return shape;
}

MaybeForm finish(const ShapeNode& at, TerrainShape& shape) {
  return unless_empty<Terrain>(at, shape, "the landscape lies below its base");
}

}  // namespace oktett
