#include "core/transform.h"

#include <string>

#include "io/scene/values.h"

namespace oktett {
namespace {

Affine read_scale(SceneValues& values, const YamlNode& node) {
  if (node.kind == YamlKind::sequence) return Affine::scaling(values.vector(node));
  const double s = values.number(node);
  return Affine::scaling({s, s, s});
}

Affine read_rotate(SceneValues& values, const YamlNode& node) {
  if (node.kind != YamlKind::map) return Affine::rotation(values.vector(node));
  const Fields fields(node, "rotate", {"axis", "angle"});
  const YamlNode& axis_node = fields.require("axis");
  const Vec3d axis = values.vector(axis_node);
  // Divided by its greatest component, so that neither a huge nor a tiny axis leaves the range of its squared
  // length.
  const double greatest = max_component(abs(axis));
  if (greatest == 0) throw Error(axis_node.where(), "the axis of a rotation must not be zero");
  return Affine::rotation(axis / greatest, values.number(fields.require("angle")));
}

Affine read_matrix(SceneValues& values, const YamlNode& node) {
  if (node.kind != YamlKind::sequence || (node.items.size() != 12 && node.items.size() != 16)) {
    const std::string found =
        node.kind == YamlKind::sequence ? std::to_string(node.items.size()) : node.describe();
    throw Error(node.where(), "expected 12 or 16 numbers, row by row, found " + found);
  }
  Affine a;
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const double value = values.number(*node.items[i]);
    if (i < 12)
      a.m[i / 4][i % 4] = value;
    else if (value != (i == 15 ? 1 : 0))
      throw Error(node.items[i]->where(), "the last row of a matrix must be 0, 0, 0, 1");
  }
  return a;
}

Affine read_operation(SceneValues& values, const YamlNode& node) {
  const Fields fields(node, "a transform", {"translate", "scale", "rotate", "matrix"});
  declare_one_of(node, {"translate", "scale", "rotate", "matrix"});
  if (node.kind != YamlKind::map || node.items.size() != 2)
    throw Error(node.where(), "expected one of translate, scale, rotate and matrix; several make a list");
  if (const YamlNode* translate = fields["translate"]) return Affine::translation(values.vector(*translate));
  if (const YamlNode* scale = fields["scale"]) return read_scale(values, *scale);
  if (const YamlNode* rotate = fields["rotate"]) return read_rotate(values, *rotate);
  return read_matrix(values, fields.require("matrix"));
}

}  // namespace

Affine read_transform(SceneValues& values, const YamlNode& node) {
  if (node.kind == YamlKind::map) return read_operation(values, node);
  Affine total;
  for (const YamlNode* operation : list_items(node, "transform"))
    attempt(*operation, [&] { total = read_operation(values, *operation) * total; });
  return total;
}

}  // namespace oktett
