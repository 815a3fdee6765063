/// \file Transforms in scene files, also by time.

#include "core/transform.h"

#include <fmt/format.h>

#include <memory>
#include <string>

#include "io/scene/readers.h"
#include "io/scene/schema.h"

namespace oktett {
namespace {

/// More keys than any curve needs.
constexpr std::size_t kMostKeys = 4096;

std::string vector_schema(Schema&) { return Schema::vector(); }

Affine read_translate(SceneLoad& load, const YamlNode& node) {
  return Affine::translation(load.values.vector(node));
}

Affine read_scale(SceneLoad& load, const YamlNode& node) {
  if (node.kind == YamlKind::sequence) return Affine::scaling(load.values.vector(node));
  const double s = load.values.number(node);
  return Affine::scaling({s, s, s});
}
std::string scale_schema(Schema&) { return Schema::any_of({Schema::number(kAnyNumber), Schema::vector()}); }

/// A rotation about an axis.
struct Turn {
  Vec3d axis{0, 1, 0};
  double angle = 0;

  void describe(auto& p) {
    p.required("axis", axis, "of any length but zero");
    p.check(max_component(abs(axis)) > 0, "axis", "the axis of a rotation must not be zero");
    p.required("angle", angle, "degrees about it");
  }
};

Affine read_rotate(SceneLoad& load, const YamlNode& node) {
  if (node.kind != YamlKind::map) return Affine::rotation(load.values.vector(node));
  Turn turn;
  read_described(load, node, "rotate", turn);
  // Divided by its greatest component, so that neither a huge nor a tiny axis leaves the range of its squared
  // length.
  return Affine::rotation(turn.axis / max_component(abs(turn.axis)), turn.angle);
}
std::string rotate_schema(Schema& schema) {
  return Schema::any_of({Schema::vector(), schema.map("rotate", Turn{})});
}

Affine read_matrix(SceneLoad& load, const YamlNode& node) {
  if (node.kind != YamlKind::sequence || (node.items.size() != 12 && node.items.size() != 16)) {
    const std::string found =
        node.kind == YamlKind::sequence ? std::to_string(node.items.size()) : node.describe();
    throw Error(node.where(), "expected 12 or 16 numbers, row by row, found " + found);
  }
  Affine a;
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const double value = load.values.number(*node.items[i]);
    if (i < 12)
      a.m[i / 4][i % 4] = value;
    else if (value != (i == 15 ? 1 : 0))
      throw Error(node.items[i]->where(), "the last row of a matrix must be 0, 0, 0, 1");
  }
  return a;
}
std::string matrix_schema(Schema&) { return Schema::any_of({Schema::numbers(12), Schema::numbers(16)}); }

struct Operation {
  const char *key, *meaning;
  Affine (*read)(SceneLoad&, const YamlNode&);
  std::string (*schema)(Schema&);
};
constexpr Operation kOperations[] = {
    {"translate", "moves by a vector", read_translate, vector_schema},
    {"scale", "stretches by a number or along the axes", read_scale, scale_schema},
    {"rotate", "turns by degrees about x, then y, then z, or about an axis", read_rotate, rotate_schema},
    {"matrix", "12 or 16 numbers, row by row", read_matrix, matrix_schema}};

Affine read_operation(SceneLoad& load, const YamlNode& node) {
  const char* keys[std::size(kOperations)];
  for (std::size_t i = 0; i < std::size(keys); ++i) keys[i] = kOperations[i].key;
  const Fields fields(node, "a transform", keys);
  if (node.kind != YamlKind::map || node.items.size() != 2)
    throw Error(node.where(), "expected one of translate, scale, rotate and matrix; several make a list");
  for (const Operation& operation : kOperations)
    if (const YamlNode* value = fields[operation.key]) return operation.read(load, *value);
  throw FollowingError();  // an unknown key, which is an error already
}

}  // namespace

Affine read_transform(SceneLoad& load, const YamlNode& node) {
  if (node.kind == YamlKind::map) return read_operation(load, node);
  Affine total;
  for (const YamlNode* operation : list_items(node, "transform"))
    attempt(*operation, [&] { total = read_operation(load, *operation) * total; });
  return total;
}

void read_value(SceneLoad& load, const YamlNode& node, const Range&, Affine& transform) {
  transform = read_transform(load, node);
}

std::string schema_of(Schema& schema, const Range&, const Affine&) {
  const std::string operation = schema.one_of("a transform", kOperations);
  return Schema::any_of({Schema::list(operation), operation});
}

std::vector<MotionKey> read_motion(SceneLoad& load, const YamlNode& node) {
  std::vector<MotionKey> keys;
  const auto read_key = [&](const YamlNode* item) {
    MotionKey key;
    const Fields fields = read_described(load, *item, MotionKey::kMap, key);
    if (!keys.empty() && !(key.time > keys.back().time))
      throw Error(fields.require("time").where(),
                  fmt::format("the times of a motion must ascend: expected more than {}", keys.back().time));
    const Location place = fields.require("transform").where();
    if (const std::string reason = why_degenerate(key.transform); !reason.empty())
      throw Error(place, reason + ", which a motion cannot pass");
    if (!keys.empty() && (key.transform.determinant() < 0) != (keys.back().transform.determinant() < 0))
      throw Error(place, "a motion cannot turn a thing into its mirror image");
    keys.push_back(key);
    if (keys.size() > kMostKeys)
      throw Error(item->where(), fmt::format("a motion has more than {} keys", kMostKeys));
  };
  for (const YamlNode* item : list_items(node, "motion")) attempt(*item, [&] { read_key(item); });
  if (keys.empty()) throw Error(node.where(), "a motion needs at least one key {time, transform}");
  return keys;
}

void read_value(SceneLoad& load, const YamlNode& node, const Range&, MotionPointer& motion) {
  motion = std::make_shared<const Motion>(Motion{{read_motion(load, node)}});
}

std::string schema_of(Schema& schema, const Range&, const MotionPointer&) {
  return Schema::list(schema.map(MotionKey::kMap, MotionKey{}), whole(1, kMostKeys));
}

}  // namespace oktett
