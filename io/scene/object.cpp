#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "io/scene/readers.h"
#include "io/scene/schema.h"
#include "io/yaml/utf8.h"
#include "render/recentre.h"
#include "render/solids.h"

namespace oktett {

static std::string object_schema(Schema& schema);

namespace {

/// What a group hands to its members.
struct Surroundings {
  Affine transform;
  std::uint32_t material = kNoId;
  std::string name;         ///< of members without one
  bool is_dropped = false;  ///< the members are checked but not kept
  Motion motion;            ///< its value at time 0 is `transform`
  std::uint8_t visible_to = kAllRays;
  std::uint32_t light_list = kNoId;
  bool shadow_catcher = false;
  bool hollow = false;
};

std::string visible_to_schema(Schema& schema) {
  std::uint8_t kinds = kAllRays;
  return schema_of(schema, kAnyNumber, RayKindSet{kinds});
}
std::string light_list_schema(Schema& schema) {
  std::uint32_t list = kNoId;
  return schema_of(schema, kAnyNumber, LightListNames{list, false});
}

std::string operands_schema(Schema& schema) { return Schema::list(object_schema(schema), kNotEmpty); }

/// What an object may have besides the one key that says what it is.
constexpr SchemaRow kObjectKeys[] = {
    {"material", "its name, or a map", material_schema},
    {"transform", "operations in order, or one",
     [](Schema& schema) { return schema_of(schema, kAnyNumber, Affine{}); }},
    {"motion", "instead of `transform`: transforms by time",
     [](Schema& schema) { return schema_of(schema, kAnyNumber, MotionPointer{}); }},
    {"name", "for mattes and lights; no two objects have the same", [](Schema&) { return Schema::text(); }},
    {"visible_to", "the rays that meet it; all if left out", visible_to_schema},
    {"shadow_catcher", "the camera sees only the shadows on it", [](Schema&) { return Schema::boolean(); }},
    {"hollow", "fog is in the solid, too", [](Schema&) { return Schema::boolean(); }},
    {"seen_through", "of a combination: solids; only rays that run through each of them meet it",
     operands_schema},
    {"lights_only", "of what glows: the objects that it lights", light_list_schema},
    {"lights_except", "of what glows: the objects that it does not light", light_list_schema}};

/// What an object may be besides a shape that describes its parameters.
constexpr SchemaRow kOtherShapes[] = {
    {"spheres", "many balls", spheres_schema},
    {kCsgKeys[0].name, "what is in any of the solids", operands_schema},
    {kCsgKeys[1].name, "what is in all of the solids", operands_schema},
    {kCsgKeys[2].name, "what is in the first solid and in no other", operands_schema},
    {kCsgKeys[3].name, "as an operand of these: shapes of which only the surfaces count", operands_schema},
    {"group", "objects, with one transform, and one material and name for those without their own",
     objects_schema},
    {"instance", "the prototype of this name", [](Schema&) { return Schema::text(); }}};

/// Every key that says what an object is.
const std::vector<std::string>& kinds_of_objects() {
  static const std::vector<std::string> keys = [] {
    std::vector<std::string> all = shape_keys();
    for (const auto& other : kOtherShapes) all.emplace_back(other.key);
    return all;
  }();
  return keys;
}

/// Several objects as one operand: their union.
Object unite(std::vector<Object> members, const Location& where) {
  if (members.size() == 1) return std::move(members.front());
  Object object;
  object.shape = CsgShape{CsgOp::unite, std::make_shared<const std::vector<Object>>(std::move(members))};
  object.where = where;
  return object;
}

/// The one entry of an object that says what it is. Throws Error for keys that no object has. Where errors
/// are gathered, an object without a shape has null entries.
MapEntry find_shape(const YamlNode& node) {
  const std::vector<std::string>& shapes = kinds_of_objects();
  const std::string shape_names = fmt::format("{}", fmt::join(shapes, ", "));
  std::vector<std::string> known = shapes;
  for (const auto& other : kObjectKeys) known.emplace_back(other.key);
  MapEntry shape{nullptr, nullptr};
  for (const MapEntry& entry : map_entries(node, "an object")) {
    const std::string& key = entry.key->text;
    if (std::ranges::find(known, key) == known.end()) {
      const std::string hint = suggest(key, known);
      report(*entry.key, "unknown key " + quote(key) + " in an object" +
                             (hint.empty() ? "; shapes are " + shape_names : hint));
    }
    if (std::ranges::find(shapes, key) == shapes.end()) continue;
    if (shape.key)
      report(*entry.key,
             "an object has one shape, but " + quote(shape.key->text) + " and " + quote(key) + " are given");
    else
      shape = entry;
  }
  if (shape.key) return shape;
  const Error error(node.where(), "an object needs a shape: one of " + shape_names);
  if (node.file->errors == nullptr) throw error;
  node.file->errors->add_if_first(error);
  return shape;
}

/// Reads the objects of the world or of one prototype, groups flattened.
class ObjectReader {
 public:
  /// `defining` is the map of prototypes that is being read, `name` the one in it that the objects belong to;
  /// null and empty for the world.
  ObjectReader(SceneLoad& load, std::vector<Object>& out, const YamlNode* defining, std::string name)
      : load_(load), out_(out), defining_(defining), name_(std::move(name)) {}

  void read(const YamlNode& node, const Surroundings& outer) {
    attempt(node, [&] { read_object(node, outer); });
  }

  /// Levels of instances below what has been read.
  int levels() const { return levels_; }

 private:
  void read_object(const YamlNode& node, const Surroundings& outer) {
    const auto [key, value] = find_shape(node);
    const std::string kind = key ? key->text : "";
    const char* known[1 + std::size(kObjectKeys)] = {kind.c_str()};
    for (std::size_t i = 0; i < std::size(kObjectKeys); ++i) known[i + 1] = kObjectKeys[i].key;
    const Fields fields(node, "an object", known);
    const bool is_group = kind == "group", is_instance = kind == "instance";

    Object object;
    object.where = node.where();
    const std::size_t first = out_.size();
    if (const YamlNode* name = fields["name"])
      attempt(*name, [&] {
        object.name = load_.values.text(*name);
        load_.objects.add(object.name, 0, name->where(), "object");
      });
    // A prototype keeps its own materials inside a group, since it is meant to look the same everywhere.
    Surroundings inner{outer.transform,
                       is_instance ? kNoId : outer.material,
                       object.name.empty() ? outer.name : object.name,
                       outer.is_dropped,
                       outer.motion,
                       outer.visible_to,
                       is_instance ? kNoId : outer.light_list,
                       outer.shadow_catcher,
                       outer.hollow};
    if (const YamlNode* material = fields["material"])
      attempt(*material, [&] { inner.material = read_material(load_, *material); });
    if (const YamlNode* transform = fields["transform"])
      attempt(*transform, [&] { read_transform_of(*transform, is_group, outer, inner); });
    if (const YamlNode* motion = fields["motion"])
      attempt(*motion, [&] {
        if (fields["transform"])
          throw Error(motion->where(),
                      "expected 'transform' or 'motion', not both; a group can have the other");
        read_motion_of(*motion, inner);
      });
    read_visibility(fields, inner);
    std::vector<Object> windows;
    if (const YamlNode* list = fields["seen_through"])
      attempt(*list, [&] { windows = read_windows(kind, *list); });
    if (!key) return;
    const std::string own_name = object.name;
    if (is_group)
      for (const YamlNode* member : list_items(*value, "group")) read(*member, inner);
    else
      add_shape(*key, *value, object, inner);
    if (!windows.empty() && out_.size() > first)
      if (auto* const csg = std::get_if<CsgShape>(&out_.back().shape))
        csg->windows = std::make_shared<const std::vector<Object>>(std::move(windows));
    if (!own_name.empty()) note_name(own_name, first);
  }

  /// What `name` stands for: the objects from `first` on.
  void note_name(const std::string& name, std::size_t first) {
    NamedObjects named{kNoId, first, out_.size(), is_operand_};
    if (!name_.empty()) named.prototype = static_cast<std::uint32_t>(load_.scene.prototypes.size());
    load_.named_objects.emplace(name, named);
  }

  void read_visibility(const Fields& fields, Surroundings& inner) {
    if (const YamlNode* node = fields["visible_to"])
      attempt(*node, [&] {
        if (is_operand_)
          throw Error(node->where(),
                      "what is in a combination is visible to all rays that meet the combination; expected "
                      "'visible_to' there");
        std::uint8_t kinds = kAllRays;
        RayKindSet set{kinds};
        read_value(load_, *node, kAnyNumber, set);
        inner.visible_to &= kinds;
      });
    if (const YamlNode* node = fields["shadow_catcher"])
      attempt(*node, [&] {
        if (is_operand_)
          throw Error(node->where(), "a combination is a shadow catcher as a whole; expected the key there");
        inner.shadow_catcher |= load_.values.boolean(*node);
      });
    if (const YamlNode* node = fields["hollow"])
      attempt(*node, [&] {
        if (is_operand_)
          throw Error(node->where(), "a combination is hollow as a whole; expected the key there");
        inner.hollow = load_.values.boolean(*node);
      });
    const auto read_list = [&](const YamlNode* node, bool lights_others) {
      if (node == nullptr) return;
      attempt(*node, [&] {
        if (lights_others && fields["lights_only"])
          throw Error(node->where(), "expected 'lights_only' or 'lights_except', not both");
        LightListNames names{inner.light_list, lights_others};
        read_value(load_, *node, kAnyNumber, names);
      });
    };
    read_list(fields["lights_only"], false), read_list(fields["lights_except"], true);
    if (inner.light_list != kNoId && fields["instance"] && !fields["material"])
      throw Error(
          fields["instance"]->where(),
          "without a material of its own an instance glows as its prototype does; expected the list of "
          "lit objects there");
  }

  /// Adds an object that is no group.
  void add_shape(const YamlNode& key, const YamlNode& value, Object& object, const Surroundings& inner) {
    std::optional<Shape> shape;
    if (!attempt(value, [&] { shape = read_any_shape(key, value, inner); })) return;
    if (!shape || inner.is_dropped) return;
    const std::vector<MeshShape> strokes = take_strokes(value, *shape);
    object.shape = std::move(*shape);
    object.name = inner.name;
    object.material = inner.material, object.visible_to = inner.visible_to;
    object.light_list = inner.light_list, object.shadow_catcher = inner.shadow_catcher;
    object.hollow = inner.hollow;
    object.transform = inner.transform;
    if (inner.motion.moves()) object.motion = std::make_shared<const Motion>(inner.motion);
    for (const MeshShape& each : strokes) {
      Object own = object;
      own.shape = each;
      place_mesh(own);
      out_.push_back(std::move(own));
    }
    const auto* const mesh = std::get_if<MeshShape>(&object.shape);
    if (mesh != nullptr && mesh->mesh->triangle_count() == 0) return;
    place_mesh(object);
    require_inside(object);
    out_.push_back(std::move(object));
  }

  /// The points and lines of the file of a mesh, which are no operands of combinations.
  std::vector<MeshShape> take_strokes(const YamlNode& node, Shape& shape) const {
    auto* const mesh = std::get_if<MeshShape>(&shape);
    if (mesh == nullptr) return {};
    const double width = std::exchange(mesh->stroke_width, 0);
    const MeshLibrary::Entry& entry = load_.meshes.entry_of(*mesh->mesh);
    if (entry.strokes.empty()) return {};
    if (is_operand_) {
      load_.warn(node.where(), "points and lines of the mesh are skipped: they have no inside");
      return {};
    }
    std::vector<Warning> warnings;
    std::vector<MeshShape> strokes =
        entry.stroke_shapes(width > 0 ? width : load_.gltf.stroke_width, node.where(), warnings);
    for (const Warning& warning : warnings) load_.warn(warning.where, warning.message);
    return strokes;
  }

  void read_transform_of(const YamlNode& node, bool is_group, const Surroundings& outer,
                         Surroundings& inner) {
    const Affine own = read_transform(load_, node);
    inner.transform = outer.transform * own;
    inner.motion.factors.push_back({{0, own}});
    std::string reason = why_degenerate(own);
    if (reason.empty() && !outer.is_dropped) reason = why_degenerate(inner.transform);
    if (reason.empty()) return;
    inner.is_dropped = true;
    load_.warn(node.where(), reason + (is_group ? "; the group is skipped" : "; the object is skipped"));
  }

  std::optional<Shape> read_any_shape(const YamlNode& key, const YamlNode& value, const Surroundings& inner) {
    const auto* const csg = std::ranges::find(kCsgKeys, key.text, &Choice<CsgOp>::name);
    if (csg != std::end(kCsgKeys)) return read_csg(csg->value, key, value, inner);
    return key.text == "instance" ? read_instance(value) : read_shape(load_, key, value);
  }

  void read_motion_of(const YamlNode& node, Surroundings& inner) {
    inner.motion.factors.push_back(read_motion(load_, node));
    if (inner.motion.factors.back().size() > 1 && !name_.empty())
      throw Error(node.where(), "what is in a prototype cannot move by itself; move its instances");
    if (inner.motion.factors.back().size() > 1 && is_operand_)
      throw Error(node.where(), "what is in a combination cannot move by itself; move the combination");
    Motion own;
    own.factors.push_back(inner.motion.factors.back());
    inner.transform = inner.transform * own.at(0);
  }

  /// Throws Error if the material fills the inside of the object, but there is none.
  void require_inside(const Object& object) const {
    if (object.material == kNoId) return;
    const Material& m = load_.scene.materials[object.material];
    if (m.interior == kNoId && m.priority == kNoPriority && m.surface) return;
    require_solid(load_, object, "only solids can have a material with an interior");
  }

  /// What an operand or a window consists of.
  std::vector<Object> read_operand(const YamlNode& node, const Surroundings& outer) {
    std::vector<Object> members;
    ObjectReader reader(load_, members, defining_, name_);
    reader.is_operand_ = true;
    reader.read(node, outer);
    levels_ = std::max(levels_, reader.levels_);
    return members;
  }

  std::optional<Shape> read_csg(CsgOp op, const YamlNode& key, const YamlNode& operands,
                                const Surroundings& outer) {
    const auto nodes = list_items(operands, key.text);
    if (nodes.empty()) throw Error(key.where(), key.text + " needs at least one operand");
    const bool are_surfaces = op == CsgOp::surfaces;
    if (are_surfaces && !is_operand_)
      throw Error(key.where(),
                  "'surfaces' are seen as the solids around them let them; expected the key among the "
                  "operands of 'union', 'intersection' or 'difference'");
    // Operands stand in the space of the combination, whose transform applies to all.
    const Surroundings inner{{}, outer.material, {}, outer.is_dropped, {}, kAllRays, outer.light_list};
    std::vector<Object> solids;
    bool is_nothing = false;
    for (const YamlNode* node : nodes) {
      std::vector<Object> members = read_operand(*node, inner);
      for (const Object& member : members)
        attempt(*node, [&] {
          if (are_surfaces)
            require_surface(member);
          else
            require_solid(load_, member, "only solids can be combined, others as 'surfaces'");
          require_visible(member);
        });
      // What was skipped is nothing, and so is what it is intersected with or taken from.
      const bool is_needed = op == CsgOp::intersect || (op == CsgOp::subtract && node == nodes.front());
      if (members.empty())
        is_nothing |= is_needed;
      else if (are_surfaces)
        std::ranges::move(members, std::back_inserter(solids));
      else
        solids.push_back(unite(std::move(members), node->where()));
    }
    if (is_nothing || solids.empty()) {
      if (!outer.is_dropped)
        load_.warn(key.where(), "nothing is left of the " + key.text + "; the object is skipped");
      return std::nullopt;
    }
    return CsgShape{op, std::make_shared<const std::vector<Object>>(std::move(solids))};
  }

  std::vector<Object> read_windows(const std::string& kind, const YamlNode& list) {
    if (std::ranges::find(kCsgKeys, kind, &Choice<CsgOp>::name) == std::end(kCsgKeys))
      throw Error(list.where(),
                  "only combinations are seen through solids; expected the key beside 'union', "
                  "'intersection' or 'difference'");
    if (is_operand_)
      throw Error(list.where(),
                  "what is in a combination is seen as the combination is; expected 'seen_through' there");
    const auto nodes = list_items(list, "seen_through");
    if (nodes.empty()) throw Error(list.where(), "seen_through needs at least one solid");
    std::vector<Object> windows;
    for (const YamlNode* node : nodes)
      for (Object& window : read_operand(*node, {}))
        attempt(*node, [&] {
          require_solid(load_, window, "only solids can be seen through");
          if (!is_solid(window.shape, load_.scene.prototypes))
            throw Error(node->where(), "surfaces have no inside; only solids can be seen through");
          if (holds_triangles(window))
            throw Error(node->where(),
                        "meshes and instances cannot be seen through; expected a shape such as a sphere or a "
                        "box");
          window.material = kNoId;
          windows.push_back(std::move(window));
        });
    return windows;
  }

  static bool holds_triangles(const Object& object) {
    if (const auto* const csg = std::get_if<CsgShape>(&object.shape))
      return std::ranges::any_of(*csg->operands, holds_triangles);
    return std::holds_alternative<MeshShape>(object.shape) ||
           std::holds_alternative<InstanceShape>(object.shape);
  }

  /// Throws Error if the object's surface has something inside.
  void require_surface(const Object& object) const {
    if (std::holds_alternative<CsgShape>(object.shape))
      throw Error(object.where, "a combination is an operand itself; expected other shapes in 'surfaces'");
    if (object.material == kNoId) return;
    const Material& m = load_.scene.materials[object.material];
    if (m.interior != kNoId || m.priority != kNoPriority)
      throw Error(object.where, "surfaces alone have no inside, but the material has an interior");
  }

  /// Throws Error if the operand is an instance of what is not visible to all rays.
  void require_visible(const Object& operand) const {
    const auto* const instance = std::get_if<InstanceShape>(&operand.shape);
    if (instance != nullptr && load_.prototype_hides[instance->prototype])
      throw Error(operand.where,
                  "what is in a combination must be visible to all rays, but not all of this prototype is");
  }

  std::optional<Shape> read_instance(const YamlNode& node) {
    const std::string name = load_.values.text(node);
    const NameTable::Entry* prototype = load_.prototypes.find(name);
    if (!prototype) fail_unknown_prototype(node, name);
    levels_ = std::max(levels_, load_.prototype_levels[prototype->index] + 1);
    if (levels_ > kMaxInstanceLevels)
      throw Error(node.where(),
                  fmt::format("instances are nested deeper than {} levels", kMaxInstanceLevels));
    return InstanceShape{prototype->index};
  }

  [[noreturn]] void fail_unknown_prototype(const YamlNode& node, const std::string& name) const {
    if (defining_ && name == name_)
      throw Error(node.where(), "prototype " + quote(name) + " contains itself");
    if (defining_)
      for (const auto& [key, value] : map_entries(*defining_, "define"))
        if (key->text == name)
          throw Error(node.where(),
                      fmt::format("prototype {} is defined only later, at line {}; a prototype may hold "
                                  "instances of those before it",
                                  quote(name), key->line));
    load_.prototypes.fail_unknown(name, node.where(), "prototype");
  }

  SceneLoad& load_;
  std::vector<Object>& out_;
  const YamlNode* defining_;
  std::string name_;
  bool is_operand_ = false;  ///< the objects are operands of a combination
  int levels_ = 0;
};

/// Adds the shapes that describe their parameters.
struct ShapeSchemas {
  Schema& schema;
  SchemaMap& map;

  void surface(const ShapeInfo& surface, const auto& shape) {
    map.add_one_of(surface.key, surface.meaning, schema.map(surface.key, shape));
  }
};

}  // namespace

static std::string object_schema(Schema& schema) {
  return schema.define("an object", typeid(Object), [&] {
    SchemaMap map(schema);
    ShapeSchemas shapes{schema, map};
    visit_surfaces(shapes);
    map.add_one_of(kOtherShapes);
    for (const SchemaRow& other : kObjectKeys) map.add(other.key, other.meaning, other.schema(schema));
    map.not_both("transform", "motion"), map.not_both("lights_only", "lights_except");
    return map.text();
  });
}

std::string objects_schema(Schema& schema) { return Schema::list(object_schema(schema)); }
std::string prototypes_schema(Schema& schema) { return Schema::entries(object_schema(schema)); }

void define_prototypes(SceneLoad& load, const YamlNode& define) {
  for (const auto& [key, value] : map_entries(define, "define")) {
    Prototype prototype{key->text, {}};
    ObjectReader reader(load, prototype.objects, &define, key->text);
    reader.read(*value, {});
    // Only now, so that the prototype cannot name itself.
    attempt(*key, [&, k = key] {
      load.prototypes.add(k->text, static_cast<std::uint32_t>(load.scene.prototypes.size()), k->where(),
                          "prototype");
    });
    const auto hides = [&](const Object& object) {
      const auto* const instance = std::get_if<InstanceShape>(&object.shape);
      return object.visible_to != kAllRays ||
             (instance != nullptr && load.prototype_hides[instance->prototype]);
    };
    load.prototype_hides.push_back(std::ranges::any_of(prototype.objects, hides));
    load.scene.prototypes.push_back(std::move(prototype));
    load.prototype_levels.push_back(reader.levels());
  }
}

void read_objects(SceneLoad& load, const YamlNode& objects) {
  ObjectReader reader(load, load.scene.objects, nullptr, "");
  for (const YamlNode* object : list_items(objects, "objects")) reader.read(*object, {});
}

}  // namespace oktett
