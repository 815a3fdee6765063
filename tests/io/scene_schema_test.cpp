/// \file The JSON Schema of scene files allows what the reader allows, by a validator for the part of JSON
/// Schema that it uses. Files of both kinds are read as YAML, of which JSON is a part.

#include "io/scene/schema.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>
#include <regex>
#include <string>

#include "io/yaml/scene_limits.h"
#include "io/yaml/yaml.h"
#include "tests/io/scene_test_support.h"

namespace oktett::scene_schema_test {
namespace {

const YamlNode* member(const YamlNode& map, const std::string& key) {
  for (std::size_t i = 0; i + 1 < map.items.size(); i += 2)
    if (map.items[i]->text == key) return map.items[i + 1];
  return nullptr;
}

std::optional<double> number_of(const YamlNode& node) {
  double value = 0;
  const char* const end = node.text.data() + node.text.size();
  const char* const begin = node.text.data() + (node.text.starts_with('+') ? 1 : 0);
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (node.kind != YamlKind::scalar || node.quoted || error != std::errc() || stop != end)
    return std::nullopt;
  return value;
}

bool is_type(const YamlNode& node, const std::string& type) {
  const bool boolean = !node.quoted && (node.text == "true" || node.text == "false");
  if (type == "object") return node.kind == YamlKind::map;
  if (type == "array") return node.kind == YamlKind::sequence;
  if (type == "null") return node.kind == YamlKind::null;
  if (node.kind != YamlKind::scalar) return false;
  const std::optional<double> number = number_of(node);
  if (type == "number") return number.has_value();
  if (type == "integer") return number && *number == std::floor(*number);
  if (type == "boolean") return boolean;
  return type == "string" && !number && !boolean;
}

class Validator {
 public:
  explicit Validator(const std::string& schema) {
    file_.path = "schema.json", file_.text = schema;
    parse_yaml(file_, kMaxSceneNodes);
  }
  bool accepts(const YamlNode& node) const { return accepts(node, *file_.root); }

 private:
  bool accepts(const YamlNode& node, const YamlNode& schema) const {
    for (std::size_t i = 0; i + 1 < schema.items.size(); i += 2)
      if (!keeps(node, schema.items[i]->text, *schema.items[i + 1], schema)) return false;
    return true;
  }

  bool keeps(const YamlNode& node, const std::string& rule, const YamlNode& value,
             const YamlNode& schema) const {
    const std::optional<double> number = number_of(node);
    if (rule == "$ref") {
      const std::string name = value.text.substr(std::string("#/$defs/").size());
      const YamlNode* target = member(*member(*file_.root, "$defs"), name);
      if (target == nullptr) throw Error("no definition of " + name);
      return accepts(node, *target);
    }
    if (rule == "oneOf")
      return std::ranges::count_if(value.items, [&](const YamlNode* s) { return accepts(node, *s); }) == 1;
    if (rule == "not") return !accepts(node, value);
    if (rule == "anyOf")
      return std::ranges::any_of(value.items, [&](const YamlNode* s) { return accepts(node, *s); });
    if (rule == "type") {
      if (value.kind == YamlKind::scalar) return is_type(node, value.text);
      return std::ranges::any_of(value.items, [&](const YamlNode* t) { return is_type(node, t->text); });
    }
    if (rule == "enum")
      return std::ranges::any_of(value.items, [&](const YamlNode* w) {
        return node.kind == YamlKind::scalar && node.text == w->text;
      });
    if (rule == "pattern")
      return !is_type(node, "string") || std::regex_search(node.text, std::regex(value.text));
    if (rule == "minimum") return !number || *number >= *number_of(value);
    if (rule == "maximum") return !number || *number <= *number_of(value);
    if (rule == "exclusiveMinimum") return !number || *number > *number_of(value);
    if (rule == "exclusiveMaximum") return !number || *number < *number_of(value);
    if (node.kind == YamlKind::sequence) {
      const auto size = static_cast<double>(node.items.size());
      if (rule == "minItems") return size >= *number_of(value);
      if (rule == "maxItems") return size <= *number_of(value);
      if (rule == "items")
        return std::ranges::all_of(node.items, [&](const YamlNode* n) { return accepts(*n, value); });
    }
    if (node.kind == YamlKind::map) {
      const auto size = static_cast<double>(node.items.size()) / 2;
      if (rule == "minProperties") return size >= *number_of(value);
      if (rule == "maxProperties") return size <= *number_of(value);
      if (rule == "required")
        return std::ranges::all_of(value.items,
                                   [&](const YamlNode* k) { return member(node, k->text) != nullptr; });
      if (rule == "properties" || rule == "additionalProperties")
        return keeps_members(node, rule == "properties", value, schema);
    }
    static const std::string kOthers[] = {
        "$schema", "title",    "description",   "$defs",         "minItems",   "maxItems",
        "items",   "required", "minProperties", "maxProperties", "properties", "additionalProperties"};
    EXPECT_NE(std::ranges::find(kOthers, rule), std::end(kOthers)) << "this validator does not know " << rule;
    return true;
  }

  bool keeps_members(const YamlNode& node, bool known, const YamlNode& value, const YamlNode& schema) const {
    const YamlNode* properties = member(schema, "properties");
    for (std::size_t i = 0; i + 1 < node.items.size(); i += 2) {
      const YamlNode* of = properties ? member(*properties, node.items[i]->text) : nullptr;
      if (known && of && !accepts(*node.items[i + 1], *of)) return false;
      if (known || of) continue;
      if (value.text == "false" || !accepts(*node.items[i + 1], value)) return false;
    }
    return true;
  }

  YamlFile file_;
};

class SceneSchema : public testing::Test {
 protected:
  bool accepts(const std::string& text) const {
    YamlFile file;
    file.path = "scene.yaml", file.text = text;
    parse_yaml(file, kMaxSceneNodes);
    return validator.accepts(*file.root);
  }

  const std::filesystem::path source = OKTETT_SOURCE_DIR;
  const std::string schema = scene_schema();
  const Validator validator{schema};
  test::SceneFiles files;
};

TEST_F(SceneSchema, TheCopyIsCurrent) {
  EXPECT_EQ(test::file_content(source / "docs/oktett.schema.json"), schema)
      << "expected the output of `oktett info --schema` in docs/oktett.schema.json";
}

TEST_F(SceneSchema, EveryPlaceHasATypeAndAMeaning) {
  int places = 0, meanings = 0;
  for (std::size_t at = 0; (at = schema.find("\n  \"", at)) != std::string::npos; ++at) ++places;
  for (std::size_t at = 0; (at = schema.find(": {\"description\": \"", at)) != std::string::npos; ++at)
    ++meanings;
  EXPECT_GT(places, 300);
  EXPECT_EQ(meanings, places);
  EXPECT_EQ(schema.find("{}"), std::string::npos);
}

// What users may write is told in the document, too.
TEST_F(SceneSchema, EveryKeyIsInTheDocument) {
  const std::string document = test::file_content(source / "docs/scene-format.md");
  int count = 0;
  for (std::size_t at = 0; (at = schema.find("\n  \"", at)) != std::string::npos; ++count) {
    at += 4;
    const std::string key = schema.substr(at, schema.find('"', at) - at);
    const std::regex named("[`{ ]" + key + "[`:,} ]");
    EXPECT_TRUE(std::regex_search(document, named)) << key;
  }
  EXPECT_GT(count, 300);
}

TEST_F(SceneSchema, AcceptsEveryExample) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source / "scenes")) {
    if (entry.path().extension() != ".yaml") continue;
    const std::string text = test::file_content(entry.path());
    EXPECT_TRUE(accepts(text)) << entry.path();
    EXPECT_EQ(text.find("# yaml-language-server: $schema=../docs/oktett.schema.json\n"), 0u) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 20);
}

// Each scene is right for the reader and for the schema.
TEST_F(SceneSchema, AcceptsWhatTheReaderAccepts) {
  files.dir.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  files.dir.write("a.png", "");
  for (const char* text :
       {"objects:\n",
        "camera: {from: [0, 0, '2*pi'], fov: 30.5}",
        "background: '#102030'",
        "params: {n: 3, s: x}\nobjects: [{sphere: {radius: '${n}'}}]",
        "materials: {a: {color: [1, 0, 0], roughness: 0.5}}\nobjects: [{sphere: , material: a}]",
        "materials: {a: {color: {file: a.png, scale: [1, 2]}, diffuse: {noise: {size: 2}, gain: 0.5}}}",
        "materials: {a: {principled: {eta: [1, 1, 1], k: [2, 2, 2], coat: {marble: }}}}",
        "lights: [{sphere: {center: [0, 0, 0]}}, {spot: {position: [0, 1, 0], outer_angle: 20}}, {sky: }]",
        "objects: [{mesh: {file: a.obj, test: badouel}, transform: [{scale: 2}, {rotate: {axis: [0, 1, 0], "
        "angle: 30}}, {matrix: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]}]}]",
        "objects: [{difference: [{box: }, {group: [{sphere: }, {torus: }]}]}, {spheres: [{radius: 2}]}]",
        "objects: [{spheres: {centers: [[0, 0, 0], [1, 1, 1]]}}]",
        "define: {a: {sphere: }}\nobjects: [{instance: a, name: b}]",
        "objects: [{blobtree: {sum: [{point: [0, 0, 0]}, {max: [{segment: }, {ellipsoid: {radii: [1, 2, "
        "3]}}]}]}}]",
        "objects: [{metaballs: {elements: [{point: {center: [0, 0, 0]}, potential: gaussian, b: 2}]}}]",
        "objects: [{height_field: {function: x*z, samples: [4, 5]}}]",
        "objects: [{revolution: {profile: linear, points: [[1, 0], [1, 1]]}}]",
        "objects: [{revolution: {points: [[1, 0], [1, 1], [2, 2], [1, 3]]}}]",
        "objects: [{polygon: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}}]",
        "objects: [{union: [{sphere: }]}, {group: }, {group: []}, {spheres: []}, {spheres: }]",
        "objects: [{sphere: , transform: }, {sphere: , transform: []}, {sphere: , name: a, material: {}}]",
        "objects: [{sphere: , motion: [{time: 0, transform: []}]}]",
        "objects: [{blob: {sources: [{point: [0, 0, 0], weight: 2}, {point: [1, 0, 0]}]}}]",
        "objects: [{blobtree: {difference: [{polygon: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}], iso: 0.5}}]",
        "objects: [{metaballs: {balls: [{radius: 2}], iso: 0.5}}]",
        "objects: [{ifs: {maps: [{scale: 0.5}, [{scale: 0.5}, {translate: [1, 0, 0]}]]}}]",
        "materials: {a: {color: {checker: {colors: [[1, 1, 1]]}, gain: 2}, light_group: A-z_09}}",
        "lights: [{sky: {light_group: 3}}, {sky: {light_group: true}}]",
        "params: {g: key}\nlights: [{sky: {light_group: '${g}-1'}}]",
        "objects: [{implicit: {function: 'x^2+y^2+z^2-1', bounds: {min: [-1, -1, -1], max: [1, 1, 1]}}}]"}) {
    EXPECT_EQ(files.error_v1(text), "no error") << text;
    EXPECT_TRUE(accepts("oktett: 1\n" + std::string(text))) << text;
  }
}

TEST_F(SceneSchema, RefusesWhatTheReaderRefuses) {
  for (const char* text : {"camra: {fov: 30}",
                           "camera: {fov: 180}",
                           "camera: {fov: wide}",
                           "camera: {from: [0, 0]}",
                           "camera: {projection: fish}",
                           "camera: {projection: fisheye, angle: 400}",
                           "camera: {projection: spherical, angle: [90, 90, 90]}",
                           "camera: [1, 2]",
                           "film: {width: 0}",
                           "film: {width: 2.5}",
                           "film: {crop: [0, 1, 0]}",
                           "integrator: {kind: magic}",
                           "integrator: {depth: 65}",
                           "background: red",
                           "background: [1, 1, -1]",
                           "background: '#12'",
                           "materials: {a: {colour: [1, 1, 1]}}",
                           "materials: {a: {reflection: 1.5}}",
                           "materials: {a: {ior: 0}}",
                           "materials: {a: {opacity: -0.1}}",
                           "materials: {a: {emits: none}}",
                           "materials: [a]",
                           "materials: {a: {principled: {roughness: 2}}}",
                           "materials: {a: {color: {marbel: }}}",
                           "materials: {a: {color: {noise: {octaves: 17}}}}",
                           "materials: {a: {color: {checker: {size: 0}}}}",
                           "lights: [{lamp: {}}]",
                           "lights: [{sphere: {radius: 1}}]",
                           "lights: [{sphere: {center: [0, 0, 0], radius: 0}}]",
                           "lights: {point: {position: [0, 0, 0]}}",
                           "lights: [{sky: {turbidity: 1}}]",
                           "lights: [{point: }]",
                           "objects: [{torus: {major: x}}]",
                           "objects: [{sphere: {radius: -1}}]",
                           "objects: [{sphere: {radios: 1}}]",
                           "objects: [{mesh: {smooth: true}}]",
                           "objects: [{mesh: {file: a.obj, smooth: 1}}]",
                           "objects: [{sphere: , transform: {move: [1, 0, 0]}}]",
                           "objects: [{sphere: , transform: {matrix: [1, 2]}}]",
                           "objects: [{menger: {depth: 17}}]",
                           "objects: [{union: {sphere: }}]",
                           "objects: {sphere: }",
                           "objects: [{metaballs: {balls: [{size: 1}]}}]",
                           "objects: [{polygon: {vertices: 3}}]",
                           "objects: [{polygon: {vertices: [[0, 0, 0], [1, 0, 0]]}}]",
                           "objects: [{polygon: {vertices: }}]",
                           "objects: [{}]",
                           "objects: [null]",
                           "objects: [{name: a}]",
                           "objects: [{sphere: , torus: }]",
                           "objects: [{union: [{sphere: , box: }]}]",
                           "define: {a: }",
                           "define: {a: {material: {}}}",
                           "objects: [{union: []}]",
                           "objects: [{union: }]",
                           "objects: [{intersection: []}]",
                           "objects: [{difference: []}]",
                           "objects: [{sphere: , transform: {}}]",
                           "objects: [{sphere: , transform: [{}]}]",
                           "objects: [{sphere: , transform: {scale: 2, translate: [1, 0, 0]}}]",
                           "objects: [{sphere: , motion: []}]",
                           "camera: {motion: []}",
                           "objects: [{revolution: {points: [[1, 0]]}}]",
                           "objects: [{revolution: {profile: linear, points: [[1, 0]]}}]",
                           "objects: [{blob: {sources: []}}]",
                           "objects: [{blob: {sources: [{}]}}]",
                           "objects: [{blob: {sources: [{point: [0, 0, 0], plane: {normal: [1, 0, 0]}}]}}]",
                           "objects: [{blob: {sources: [{weight: 1}]}}]",
                           "objects: [{metaballs: {}}]",
                           "objects: [{metaballs: {balls: [{radius: 1}], elements: [{point: [0, 0, 0]}]}}]",
                           "objects: [{metaballs: {elements: []}}]",
                           "objects: [{metaballs: {balls: []}}]",
                           "objects: [{metaballs: {balls: }}]",
                           "objects: [{spheres: {}}]",
                           "objects: [{spheres: {radius: 1}}]",
                           "objects: [{spheres: {centers: [[0, 0, 0]], file: a.txt}}]",
                           "objects: [{metaballs: {elements: [{weight: 1}]}}]",
                           "objects: [{metaballs: {elements: [{point: [0, 0, 0], segment: }]}}]",
                           "objects: [{blobtree: {}}]",
                           "objects: [{blobtree: {sum: []}}]",
                           "objects: [{blobtree: {sum: [{}]}}]",
                           "objects: [{blobtree: {sum: [{max: []}]}}]",
                           "objects: [{blobtree: {sum: [{point: [0, 0, 0]}], max: [{point: [0, 0, 0]}]}}]",
                           "objects: [{blobtree: {sum: [{polygon: [[0, 0, 0], [1, 0, 0]]}]}}]",
                           "objects: [{ifs: {maps: []}}]",
                           "materials: {a: {color: {}}}",
                           "materials: {a: {color: {gain: 2}}}",
                           "materials: {a: {color: {marble: , checker: }}}",
                           "materials: {a: {color: {file: a.png, checker: }}}",
                           "materials: {a: {color: {checker: {colors: []}}}}",
                           "materials: {a: {light_group: 'a b'}}",
                           "lights: [{}]",
                           "lights: [null]",
                           "lights: [{sphere: {center: [0, 0, 0]}, sky: }]",
                           "lights: [{sky: {light_group: a b}}]",
                           "lights: [{rectangle: {corner: [0, 0, 0], u: [1, 0, 0]}}]",
                           "lights: [{point: {position: [0, 0, 0], color: [1, 1, 1], power: [1, 1, 1]}}]",
                           "lights: [{spot: {position: [0, 0, 0], at: [1, 0, 0], direction: [1, 0, 0]}}]",
                           "lights: [{point: {position: [0, 0, 0], rotate: x}}]",
                           "camera: {aperture: 1, f_number: 2}",
                           "integrator: {caustics: {radius: near}}",
                           "media: {a: {density: x}}",
                           "objects: [{sphere: , transform: [], motion: [{time: 0, transform: []}]}]",
                           "objects: [{sphere: , transform: {rotate: {axis: [0, 1, 0]}}}]",
                           "objects: [{polynomial: {bounds: {min: [0, 0, 0], max: [1, 1, 1]}}}]",
                           "objects: [{quadric: {clip: {min: [0, 0]}}}]",
                           "objects: [{implicit: {function: x, bounds: {min: [0, 0, 0]}}}]",
                           "objects: [{superellipsoid: {radii: [1, -1, 1]}}]",
                           "objects: [{height_field: {function: x, samples: [4, 5, 6]}}]",
                           "objects: [{height_field: {samples: 4}}]",
                           "lights: [{sky: {light_group: ''}}]",
                           "lights: [{sky: {light_group: 3.5}}]"}) {
    EXPECT_NE(files.error_v1(text), "no error") << text;
    EXPECT_FALSE(accepts("oktett: 1\n" + std::string(text))) << text;
  }
  for (const char* text : {"objects: [{sphere: }]\n", "oktett: 2\n", "oktett: \n", "oktett: [1]\n"}) {
    EXPECT_NE(files.error(text), "no error") << text;
    EXPECT_FALSE(accepts(text)) << text;
  }
}

}  // namespace
}  // namespace oktett::scene_schema_test
