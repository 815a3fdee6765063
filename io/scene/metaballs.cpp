/// \file Metaballs and blob trees in scene files.

#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>

#include "io/scene/exact.h"
#include "io/scene/number_line.h"
#include "io/scene/readers.h"
#include "io/scene/schema.h"

namespace oktett {
namespace {

using MaybeForm = std::optional<ExactForm>;

/// Most bytes of a file of balls.
constexpr std::size_t kMaxBallFileBytes = std::size_t{1} << 28;

void check_count(std::size_t count, const Location& place) {
  if (count > kMaxBalls)
    throw Error(place, "more than " + std::to_string(kMaxBalls) + " elements in one object");
}

// Skeletons: maps of their parameters, or lists of their points.

template <class T>
T read_skeleton_map(SceneLoad& load, const YamlNode& node, const char* key) {
  T skeleton;
  read_described(load, node, key, skeleton);
  return skeleton;
}

Skeleton read_point(SceneLoad& load, const YamlNode& node) {
  if (node.kind == YamlKind::sequence) return PointSkeleton{load.values.vector(node)};
  return read_skeleton_map<PointSkeleton>(load, node, "point");
}
std::string point_schema(Schema& schema) {
  return Schema::any_of({Schema::vector(), schema.map("point", PointSkeleton{})});
}

constexpr std::uint32_t kLeastVertices = 3;

Skeleton read_polygon(SceneLoad& load, const YamlNode& node) {
  const YamlNode& list =
      node.kind == YamlKind::sequence ? node : Fields(node, "polygon", {"vertices"}).require("vertices");
  PolygonShape polygon;
  for (const YamlNode* vertex : list_items(list, "vertices"))
    polygon.vertices.push_back(load.values.vector(*vertex));
  if (polygon.vertices.size() < kLeastVertices)
    throw Error(list.where(), fmt::format("expected at least {} vertices, found {}", kLeastVertices,
                                          polygon.vertices.size()));
  if (const std::string why = why_degenerate(polygon); !why.empty()) throw Error(list.where(), why);
  return PolygonSkeleton{polygon.vertices};
}
std::string polygon_schema(Schema& schema) {
  const std::string list = Schema::list(Schema::vector(), Range{kLeastVertices, kMaxCoordinate});
  const auto map = [&] {
    SchemaMap vertices(schema);
    vertices.add_one_of("vertices", "points in one plane in order", list);
    return vertices.text();
  };
  return Schema::any_of({list, schema.define("polygon", typeid(PolygonSkeleton), map)});
}

Skeleton read_segment(SceneLoad& load, const YamlNode& node) {
  return read_skeleton_map<SegmentSkeleton>(load, node, "segment");
}
std::string segment_schema(Schema& schema) { return schema.map("segment", SegmentSkeleton{}); }

Skeleton read_ellipsoid(SceneLoad& load, const YamlNode& node) {
  return read_skeleton_map<EllipsoidSkeleton>(load, node, "ellipsoid");
}
std::string ellipsoid_schema(Schema& schema) { return schema.map("ellipsoid", EllipsoidSkeleton{}); }

constexpr struct {
  const char *key, *meaning;
  Skeleton (*read)(SceneLoad&, const YamlNode&);
  std::string (*schema)(Schema&);
} kSkeletons[] = {{"point", "a point", read_point, point_schema},
                  {"segment", "a line between two points", read_segment, segment_schema},
                  {"polygon", "points in one plane in order", read_polygon, polygon_schema},
                  {"ellipsoid", "an ellipsoid", read_ellipsoid, ellipsoid_schema}};

// Elements

struct PotentialKeys {
  Potential potential{};
  double radius = 1, b = 1;

  void describe(auto& p) {
    p.choice("potential", potential.kind,
             {{"inverse_square", PotentialKind::inverse_square},
              {"gaussian", PotentialKind::gaussian},
              {"quadratic", PotentialKind::quadratic},
              {"rational", PotentialKind::rational},
              {"wyvill", PotentialKind::wyvill}},
             "how it falls with the distance");
    p.field("radius", radius, kPositive, "how far it reaches, of all but `gaussian` and `quadratic`");
    p.field("b", b, kPositive, "how it falls, of `gaussian` and `quadratic`");
    p.field("d", potential.d, kNonNegative, "how it falls, of `rational`");
    p.field("weight", potential.weight, kStrength, "of either sign");
  }
};

Potential finish_potential(const Fields& fields, PotentialKeys& keys) {
  Potential& p = keys.potential;
  const bool by_b = p.kind == PotentialKind::gaussian || p.kind == PotentialKind::quadratic;
  p.scale = by_b ? keys.b : keys.radius;
  for (const char* key : {"b", "radius", "d"}) {
    const YamlNode* value = fields[key];
    const bool meant = key[0] == 'd' ? p.kind == PotentialKind::rational : (key[0] == 'b') == by_b;
    if (value && !meant) throw Error(value->where(), std::string("this potential has no '") + key + "'");
  }
  return p;
}

/// A map with the key of a skeleton and its potential.
FieldElement read_element(SceneLoad& load, const YamlNode& node) {
  PotentialKeys keys;
  std::vector<const char*> known;
  for (const auto& skeleton : kSkeletons) known.push_back(skeleton.key);
  std::ranges::copy(KeyList(keys).keys, std::back_inserter(known));
  const Fields fields(node, "element", known);
  ParameterReader reader(load, node, fields);
  keys.describe(reader);
  FieldElement element;
  element.potential = finish_potential(fields, keys);
  const char* found = nullptr;
  for (const auto& skeleton : kSkeletons) {
    const YamlNode* value = fields[skeleton.key];
    if (!value) continue;
    if (found)
      throw Error(value->where(),
                  std::string("an element has one skeleton: '") + found + "' or '" + skeleton.key + "'");
    found = skeleton.key;
    element.skeleton = skeleton.read(load, *value);
  }
  if (!found) throw Error(node.where(), "expected a skeleton: point, segment, polygon or ellipsoid");
  return element;
}

/// The keys of an element.
void add_element(SchemaMap& map) {
  map.add_one_of(kSkeletons);
  PotentialKeys{}.describe(map);
}

bool all_metaballs(const std::vector<FieldElement>& elements) {
  return std::none_of(elements.begin(), elements.end(), [](const FieldElement& e) {
    return std::holds_alternative<PolygonSkeleton>(e.skeleton) || e.potential.kind != PotentialKind::wyvill;
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
  if (items.empty()) throw Error(list.where(), "the list of elements is empty");
  check_count(items.size(), list.where());
  for (const YamlNode* item : items)
    attempt(*item, [&] { tree.elements.push_back(read_element(at.load, *item)); });
  if (none_positive(tree)) return at.skip("no element has a positive weight");
  if (all_metaballs(tree.elements)) {
    MetaballsShape shape{iso, {}};
    for (const FieldElement& e : tree.elements)
      if (const auto* const point = std::get_if<PointSkeleton>(&e.skeleton))
        shape.balls.push_back({point->center, e.potential.scale, e.potential.weight});
      else
        shape.elements.push_back(e);
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

std::string elements_schema(Schema& schema) {
  const auto element = [&] {
    SchemaMap map(schema);
    add_element(map);
    return map.text();
  };
  return Schema::list(schema.define("element", typeid(FieldElement), element), kNotEmpty);
}

std::string blends_schema(Schema& schema) {
  const auto blend = [&] {
    SchemaMap map(schema);
    add_element(map);
    for (const Choice<Blend::Op>& b : kBlends) map.add_one_of(b.name, "a blend", blends_schema(schema));
    return map.text();
  };
  return Schema::list(schema.define("a blend or an element", typeid(Blend), blend), kNotEmpty);
}

MaybeForm finish(const ShapeNode& at, MetaballsShape& shape) {
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
  for (const Choice<Blend::Op>& blend : kBlends) found |= at.fields[blend.name] != nullptr;
  if (!found) throw Error(at.node.where(), "a blobtree needs one of 'sum', 'max', 'min' and 'difference'");
  read_blend(at.load, at.node, 1, tree);
  if (none_positive(tree)) return at.skip("no element has a positive weight");
  return tree;
}

}  // namespace oktett
