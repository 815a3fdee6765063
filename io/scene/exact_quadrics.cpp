/// \file Cylinders, cones, polyhedra and quadrics in scene files.

#include <algorithm>

#include "io/scene/exact.h"
#include "kernels/exact/half_spaces.h"

namespace oktett {
namespace {

using MaybeForm = std::optional<ExactForm>;

MaybeForm read_cylinder(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "cylinder", {"from", "to", "radius", "open", "normals"});
  CylinderShape shape;
  load.values.read(fields["from"], shape.from);
  load.values.read(fields["to"], shape.to);
  load.values.read(fields["radius"], shape.radius, kNonNegative);
  load.values.read(fields["open"], shape.open);
  if (shape.radius == 0) return skip_exact(load, key, "the radius is zero");
  if (!(length(shape.to - shape.from) > 0)) return skip_exact(load, key, "the ends of the axis coincide");
  return shape;
}

MaybeForm read_cone(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "cone", {"from", "to", "from_radius", "to_radius", "open", "normals"});
  ConeShape shape;
  load.values.read(fields["from"], shape.from);
  load.values.read(fields["to"], shape.to);
  load.values.read(fields["from_radius"], shape.from_radius, kNonNegative);
  load.values.read(fields["to_radius"], shape.to_radius, kNonNegative);
  load.values.read(fields["open"], shape.open);
  if (shape.from_radius == 0 && shape.to_radius == 0) return skip_exact(load, key, "both radii are zero");
  if (!(length(shape.to - shape.from) > 0)) return skip_exact(load, key, "the ends of the axis coincide");
  return shape;
}

MaybeForm read_polyhedron(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "polyhedron", {"planes", "normals"});
  const YamlNode& planes = fields.require("planes");
  const auto items = list_items(planes, "planes");
  if (items.size() > kMaxHalfSpaces)
    throw Error(planes.where(), "expected at most " + std::to_string(kMaxHalfSpaces) + " planes, found " +
                                    std::to_string(items.size()));
  PolyhedronShape shape;
  for (const YamlNode* item : items) {
    double p[4];
    load.values.numbers(*item, p);
    const HalfSpace h{{p[0], p[1], p[2]}, p[3]};
    if (!(length(h.normal) > 0)) throw Error(item->where(), "the normal of a plane must not be zero");
    shape.planes.push_back(h);
  }
  switch (intersect(shape.planes).kind) {
    case ConvexSolid::Kind::unbounded:
      throw Error(planes.where(), "the planes do not bound a solid on all sides");
    case ConvexSolid::Kind::empty:
      return skip_exact(load, key, "there is nothing inside of all planes");
    case ConvexSolid::Kind::solid:
      break;
  }
  return shape;
}

/// The box {min, max} that a quadric is cut by.
void read_clip(SceneLoad& load, const Fields& fields, QuadricShape& shape) {
  load.values.read(fields["open"], shape.open);
  const YamlNode* const clip = fields["clip"];
  if (!clip) return;
  const Fields box(*clip, "clip", {"min", "max"});
  shape.clipped = true;
  load.values.read(box["min"], shape.lo);
  load.values.read(box["max"], shape.hi);
  for (int axis = 0; axis < 3; ++axis)
    if (shape.lo[axis] > shape.hi[axis])
      throw Error((box["max"] ? *box["max"] : *clip).where(),
                  std::string("the clip box has min > max along ") + "xyz"[axis]);
}

/// Nothing after a warning if no point is on the surface for a reason that can be seen.
MaybeForm unless_degenerate(SceneLoad& load, const YamlNode& key, const QuadricShape& shape) {
  const auto& c = shape.coefficients;
  if (std::all_of(c.begin(), c.end() - 1, [](double x) { return x == 0; }))
    return skip_exact(load, key, "the equation does not depend on x, y or z");
  if (!(shape.lo.x < shape.hi.x && shape.lo.y < shape.hi.y && shape.lo.z < shape.hi.z))
    return skip_exact(load, key, "the clip box has no volume");
  return shape;
}

MaybeForm read_quadric(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "quadric", {"coefficients", "clip", "open", "normals"});
  QuadricShape shape;
  if (const YamlNode* c = fields["coefficients"]) load.values.numbers(*c, shape.coefficients);
  read_clip(load, fields, shape);
  return unless_degenerate(load, key, shape);
}

MaybeForm read_infinite_cylinder(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  QuadricShape shape;
  shape.coefficients = {1, 1, 0, 0, 0, 0, 0, 0, 0, -1};
  read_clip(load, Fields(node, "infinite_cylinder", {"clip", "open", "normals"}), shape);
  return unless_degenerate(load, key, shape);
}

MaybeForm read_paraboloid(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  QuadricShape shape;
  shape.coefficients = {1, 1, 0, 0, 0, 0, 0, 0, -1, 0};
  read_clip(load, Fields(node, "paraboloid", {"clip", "open", "normals"}), shape);
  return unless_degenerate(load, key, shape);
}

MaybeForm read_hyperboloid(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "hyperboloid", {"sheets", "clip", "open", "normals"});
  QuadricShape shape;
  const YamlNode* const sheets = fields["sheets"];
  const bool two = sheets && load.values.integer(*sheets, 1, 2) == 2;
  shape.coefficients = {1, 1, -1, 0, 0, 0, 0, 0, 0, two ? 1.0 : -1.0};
  read_clip(load, fields, shape);
  return unless_degenerate(load, key, shape);
}

constexpr ExactReader kReaders[] = {
    {"cylinder", read_cylinder},
    {"cone", read_cone},
    {"polyhedron", read_polyhedron},
    {"quadric", read_quadric},
    {"infinite_cylinder", read_infinite_cylinder},
    {"paraboloid", read_paraboloid},
    {"hyperboloid", read_hyperboloid},
};

}  // namespace

std::span<const ExactReader> closed_form_readers() { return kReaders; }

}  // namespace oktett
