/// \file Superquadrics and ratioquadrics in scene files.

#include <cmath>

#include "io/scene/exact.h"
#include "kernels/exact/superquadric.h"

namespace oktett {
namespace {

using MaybeForm = std::optional<ExactForm>;
using Form = SuperquadricShape::Form;

/// Nothing overflows with exponents up to this, and the shape is its box to within a thousandth.
constexpr Range kExponent{0, 1024, true};

void read_radii(SceneLoad& load, const Fields& fields, SuperquadricShape& shape) {
  const YamlNode* const node = fields["radii"];
  if (!node) return;
  double r[3];
  load.values.numbers(*node, r);
  for (int k = 0; k < 3; ++k)
    if (r[k] < 0) throw Error(node->where(), "the radii must not be negative");
  shape.radii = {r[0], r[1], r[2]};
}

MaybeForm unless_degenerate(SceneLoad& load, const YamlNode& key, const SuperquadricShape& shape) {
  if (shape.radii.x == 0 || shape.radii.y == 0 || shape.radii.z == 0)
    return skip_exact(load, key, "a radius is zero");
  return shape;
}

template <bool kRatio>
MaybeForm read_ellipsoid(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, kRatio ? "ratioellipsoid" : "superellipsoid",
                      {"radii", "p", "q", "r", "normals"});
  SuperquadricShape shape;
  shape.ratio = kRatio;
  read_radii(load, fields, shape);
  load.values.read(fields["p"], shape.p, kExponent);
  load.values.read(fields["q"], shape.q, kExponent);
  load.values.read(fields["r"], shape.r, kExponent);
  return unless_degenerate(load, key, shape);
}

template <bool kRatio>
MaybeForm read_hyperboloid(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, kRatio ? "ratiohyperboloid" : "superhyperboloid",
                      {"radii", "p", "q", "r", "clip", "open", "normals"});
  SuperquadricShape shape;
  shape.form = Form::hyperboloid, shape.ratio = kRatio;
  read_radii(load, fields, shape);
  load.values.read(fields["p"], shape.p, kExponent);
  load.values.read(fields["q"], shape.q, kExponent);
  load.values.read(fields["r"], shape.r, kExponent);
  load.values.read(fields["open"], shape.open);
  if (const YamlNode* const clip = fields["clip"]) {
    const Fields box(*clip, "clip", {"min", "max"});
    load.values.read(box["min"], shape.lo);
    load.values.read(box["max"], shape.hi);
    for (int axis = 0; axis < 3; ++axis)
      if (shape.lo[axis] > shape.hi[axis])
        throw Error((box["max"] ? *box["max"] : *clip).where(),
                    std::string("the clip box has min > max along ") + "xyz"[axis]);
  }
  if (!(shape.lo.x < shape.hi.x && shape.lo.y < shape.hi.y && shape.lo.z < shape.hi.z))
    return skip_exact(load, key, "the clip box has no volume");
  return unless_degenerate(load, key, shape);
}

template <bool kRatio>
MaybeForm read_toroid(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, kRatio ? "ratiotoroid" : "supertoroid",
                      {"radii", "m", "n", "q", "r", "p", "d", "e", "normals"});
  SuperquadricShape shape;
  shape.form = Form::toroid, shape.ratio = kRatio, shape.q = 0.5;
  read_radii(load, fields, shape);
  load.values.read(fields["m"], shape.m, kExponent);
  load.values.read(fields["n"], shape.n, kExponent);
  load.values.read(fields["q"], shape.q, kExponent);
  load.values.read(fields["r"], shape.r, kExponent);
  load.values.read(fields["p"], shape.p, kExponent);
  load.values.read(fields["d"], shape.d, kNonNegative);
  load.values.read(fields["e"], shape.e, kNonNegative);
  if (shape.e == 0) return skip_exact(load, key, "the tube has no thickness");
  if (const Vec3d far = Superquadric::reach(shape); !std::isfinite(far.x + far.y + far.z))
    throw Error(key.where(), "the toroid has no end: a pseudo-power stays below what it would have to reach");
  return unless_degenerate(load, key, shape);
}

constexpr ExactReader kReaders[] = {
    {"superellipsoid", read_ellipsoid<false>},    {"superhyperboloid", read_hyperboloid<false>},
    {"supertoroid", read_toroid<false>},          {"ratioellipsoid", read_ellipsoid<true>},
    {"ratiohyperboloid", read_hyperboloid<true>}, {"ratiotoroid", read_toroid<true>},
};

}  // namespace

std::span<const ExactReader> superquadric_readers() { return kReaders; }

}  // namespace oktett
