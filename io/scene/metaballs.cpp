/// \file Metaballs and blob trees in scene files.

#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>

#include "io/scene/exact.h"
#include "io/scene/number_line.h"
#include "io/scene/readers.h"
#include "io/scene/shape_reader.h"

namespace oktett {
namespace {

using MaybeForm = std::optional<ExactForm>;

/// Most bytes of a file of balls.
constexpr std::size_t kMaxBallFileBytes = std::size_t{1} << 28;

void check_count(std::size_t count, const Location& place) {
  if (count > kMaxBalls)
    throw Error(place, "more than " + std::to_string(kMaxBalls) + " elements in one object");
}

// Skeletons

PolygonSkeleton read_polygon(SceneLoad& load, const YamlNode& node) {
  const YamlNode& list =
      node.kind == YamlKind::sequence ? node : Fields(node, "polygon", {"vertices"}).require("vertices");
  PolygonShape polygon;
  declare_count(list, {3, kMaxCoordinate});
  for (const YamlNode* vertex : list_items(list, "vertices"))
    polygon.vertices.push_back(load.values.vector(*vertex));
  if (polygon.vertices.size() < 3)
    throw Error(list.where(),
                "expected at least 3 vertices, found " + std::to_string(polygon.vertices.size()));
  if (const std::string why = why_degenerate(polygon); !why.empty()) throw Error(list.where(), why);
  return {polygon.vertices};
}

// Elements

/// A map of the parameters of T, or a list of its points.
template <class T>
void read_skeleton(SceneLoad& load, const YamlNode& node, const char* what, Skeleton& out) {
  T skeleton;
  if constexpr (std::is_same_v<T, PolygonSkeleton>) {
    skeleton = read_polygon(load, node);
  } else if (std::is_same_v<T, PointSkeleton> && node.kind == YamlKind::sequence) {
    skeleton = {load.values.vector(node)};
  } else {
    read_described(load, node, what, skeleton);
  }
  out = std::move(skeleton);
}

constexpr struct {
  const char* key;
  void (*read)(SceneLoad&, const YamlNode&, const char* what, Skeleton&);
} kSkeletons[] = {{"point", read_skeleton<PointSkeleton>},
                  {"segment", read_skeleton<SegmentSkeleton>},
                  {"polygon", read_skeleton<PolygonSkeleton>},
                  {"ellipsoid", read_skeleton<EllipsoidSkeleton>}};

std::vector<std::string> skeleton_keys() {
  std::vector<std::string> keys;
  for (const auto& skeleton : kSkeletons) keys.emplace_back(skeleton.key);
  return keys;
}

Potential read_potential(SceneLoad& load, const Fields& fields) {
  Potential p;
  if (const YamlNode* kind = fields["potential"])
    p.kind = load.values.choice<PotentialKind>(*kind, {{"inverse_square", PotentialKind::inverse_square},
                                                       {"gaussian", PotentialKind::gaussian},
                                                       {"quadratic", PotentialKind::quadratic},
                                                       {"rational", PotentialKind::rational},
                                                       {"wyvill", PotentialKind::wyvill}});
  const bool by_b = p.kind == PotentialKind::gaussian || p.kind == PotentialKind::quadratic;
  load.values.read(fields[by_b ? "b" : "radius"], p.scale, kPositive);
  if (p.kind == PotentialKind::rational) load.values.read(fields["d"], p.d, kNonNegative);
  load.values.read(fields["weight"], p.weight, kStrength);
  for (const char* key : {"b", "radius", "d"}) {
    const YamlNode* value = fields[key];
    const bool meant = key[0] == 'd' ? p.kind == PotentialKind::rational : (key[0] == 'b') == by_b;
    if (value && !meant) throw Error(value->where(), std::string("this potential has no '") + key + "'");
  }
  return p;
}

constexpr const char* kElementKeys[] = {"point",  "segment", "polygon", "ellipsoid", "potential",
                                        "radius", "b",       "d",       "weight"};

/// A map with the key of a skeleton and its potential.
FieldElement read_element(SceneLoad& load, const YamlNode& node) {
  const Fields fields(node, "element", kElementKeys);
  FieldElement element;
  element.potential = read_potential(load, fields);
  const char* found = nullptr;
  for (const auto& skeleton : kSkeletons) {
    const YamlNode* value = fields[skeleton.key];
    if (!value) continue;
    if (found)
      throw Error(value->where(),
                  std::string("an element has one skeleton: '") + found + "' or '" + skeleton.key + "'");
    found = skeleton.key;
    skeleton.read(load, *value, found, element.skeleton);
  }
  if (!found) throw Error(node.where(), "expected a skeleton: point, segment, polygon or ellipsoid");
  return element;
}

bool all_metaballs(const std::vector<FieldElement>& elements) {
  return std::all_of(elements.begin(), elements.end(), [](const FieldElement& e) {
    return std::holds_alternative<PointSkeleton>(e.skeleton) && e.potential.kind == PotentialKind::wyvill;
  });
}

MetaBall ball_of(NumberLine& line) {
  MetaBall ball;
  for (int axis = 0; axis < 3; ++axis) ball.center[axis] = line.number();
  ball.radius = line.number();
  if (!(ball.radius > 0)) line.reject("expected a radius greater than 0");
  if (!line.empty()) ball.strength = line.number();
  if (!kStrength.contains(ball.strength)) line.reject("the strength is out of range");
  line.finish();
  return ball;
}

bool none_positive(const BlobTreeShape& tree) {
  return std::none_of(tree.elements.begin(), tree.elements.end(),
                      [](const FieldElement& e) { return e.potential.weight > 0; });
}

MaybeForm read_elements(const ShapeNode& at, const YamlNode& list, double iso) {
  BlobTreeShape tree;
  tree.iso = iso;
  const auto items = list_items(list, "elements");
  declare_count(list, kNotEmpty);
  if (items.empty()) throw Error(list.where(), "the list of elements is empty");
  check_count(items.size(), list.where());
  for (const YamlNode* item : items)
    attempt(*item, [&] {
      tree.elements.push_back(read_element(at.load, *item));
      declare_one_of(*item, skeleton_keys());
    });
  if (none_positive(tree)) return at.skip("no element has a positive weight");
  if (all_metaballs(tree.elements)) {
    MetaballsShape shape{iso, {}};
    for (const FieldElement& e : tree.elements)
      shape.balls.push_back(
          {std::get<PointSkeleton>(e.skeleton).center, e.potential.scale, e.potential.weight});
    return shape;
  }
  for (std::uint32_t i = 0; i < tree.elements.size(); ++i) tree.blends.push_back({Blend::Op::element, i, 0});
  tree.blends.push_back({Blend::Op::sum, 0, static_cast<std::uint32_t>(tree.elements.size())});
  return tree;
}

// Trees

constexpr Choice<Blend::Op> kBlends[] = {{"sum", Blend::Op::sum},
                                         {"max", Blend::Op::max},
                                         {"min", Blend::Op::min},
                                         {"difference", Blend::Op::difference}};

/// Appends what a node of the tree stands for, in postfix order. Only the outermost one has other keys.
void read_blend(SceneLoad& load, const YamlNode& node, int level, BlobTreeShape& tree) {
  std::vector<std::string> known(std::begin(kElementKeys), std::end(kElementKeys));
  for (const Choice<Blend::Op>& blend : kBlends) known.emplace_back(blend.name);
  declare_keys(node, "a blend or an element", known);
  if (level > 1) {
    std::vector<std::string> kinds = skeleton_keys();
    for (const Choice<Blend::Op>& blend : kBlends) kinds.emplace_back(blend.name);
    declare_one_of(node, kinds);
  }
  const std::vector<MapEntry> entries = map_entries(node, "blend");
  for (const Choice<Blend::Op>& blend : kBlends) {
    const auto found =
        std::ranges::find_if(entries, [&](const MapEntry& e) { return e.key->text == blend.name; });
    if (found == entries.end()) continue;
    const YamlNode* const list = found->value;
    for (const MapEntry& entry : entries)
      if (entry.value != list && (level > 1 || (entry.key->text != "iso" && entry.key->text != "normals")))
        throw Error(entry.key->where(),
                    std::string("'") + blend.name + "' stands alone; unexpected '" + entry.key->text + "'");
    if (level > kMaxBlendLevels)
      throw Error(list->where(),
                  "blends are nested deeper than " + std::to_string(kMaxBlendLevels) + " levels");
    const auto items = list_items(*list, blend.name);
    declare_count(*list, kNotEmpty);
    if (items.empty()) throw Error(list->where(), std::string("the list of '") + blend.name + "' is empty");
    for (const YamlNode* item : items) attempt(*item, [&] { read_blend(load, *item, level + 1, tree); });
    tree.blends.push_back({blend.value, 0, static_cast<std::uint32_t>(items.size())});
    return;
  }
  tree.elements.push_back(read_element(load, node));
  check_count(tree.elements.size(), node.where());
  tree.blends.push_back({Blend::Op::element, static_cast<std::uint32_t>(tree.elements.size() - 1), 0});
}

}  // namespace

MaybeForm finish(const ShapeNode& at, MetaballsShape& shape) {
  declare_one_of(at.node, {"balls", "file", "elements"});
  const YamlNode* source = nullptr;
  for (const char* name : {"balls", "file", "elements"}) {
    if (const YamlNode* value = at.fields[name]) {
      if (source) throw Error(value->where(), "metaballs have one of 'balls', 'file' and 'elements'");
      source = value;
    }
  }
  if (!source) throw Error(at.node.where(), "metaballs need 'balls', 'file' or 'elements'");
  if (source == at.fields["elements"]) return read_elements(at, *source, shape.iso);
  if (source == at.fields["file"])
    read_number_file(at.load, *source, kMaxBallFileBytes, "the files of spheres and balls",
                     "4 or 5 numbers (x y z radius strength)", [&](NumberLine& line) {
                       shape.balls.push_back(ball_of(line));
                       check_count(shape.balls.size(), line.place());
                     });
  if (shape.balls.empty()) throw Error(source->where(), "there are no balls");
  if (std::none_of(shape.balls.begin(), shape.balls.end(), [](const MetaBall& b) { return b.strength > 0; }))
    return at.skip("no ball has a positive strength");
  return shape;
}

MaybeForm finish(const ShapeNode& at, BlobTreeShape& tree) {
  bool found = false;
  std::vector<std::string> names;
  for (const Choice<Blend::Op>& blend : kBlends) {
    names.emplace_back(blend.name);
    found |= at.fields[blend.name] != nullptr;
  }
  declare_one_of(at.node, names);
  if (!found) throw Error(at.node.where(), "a blobtree needs one of 'sum', 'max', 'min' and 'difference'");
  read_blend(at.load, at.node, 1, tree);
  if (none_positive(tree)) return at.skip("no element has a positive weight");
  return tree;
}

}  // namespace oktett
