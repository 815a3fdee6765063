/// \file The gallery shows all that scene files can say: each family of shapes, lights, media, materials and
/// patterns occurs in one of its scenes. Which there are is asked of the schema, so that a new one is missed.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "io/yaml/scene_limits.h"
#include "io/yaml/yaml.h"
#include "tests/support/temp_dir.h"

namespace oktett::scene_gallery_test {
namespace {

namespace fs = std::filesystem;

const fs::path kSource = OKTETT_SOURCE_DIR;

const YamlNode* member(const YamlNode& map, const std::string& key) {
  if (map.kind != YamlKind::map) return nullptr;
  for (std::size_t i = 0; i + 1 < map.items.size(); i += 2)
    if (map.items[i]->text == key) return map.items[i + 1];
  return nullptr;
}

/// The names of the scenes in the list of scripts/gallery.
std::vector<std::string> gallery_names() {
  const std::string script = test::file_content(kSource / "scripts/gallery");
  const std::size_t begin = script.find("\nscenes=(");
  const std::size_t end = script.find(")\n", begin);
  if (begin == std::string::npos || end == std::string::npos) return {};
  std::istringstream list(script.substr(begin + 9, end - begin - 9));
  std::vector<std::string> names;
  for (std::string name; list >> name;) names.push_back(name);
  return names;
}

/// What the scenes of the gallery use of the schema. They are read along it.
class Usage {
 public:
  Usage() {
    schema_.path = "schema.json", schema_.text = test::file_content(kSource / "docs/oktett.schema.json");
    parse_yaml(schema_, kMaxSceneNodes);
    for (const std::string& name : gallery_names()) add(kSource / "scenes" / (name + ".yaml"));
  }

  /// True if some scene has `key` in a map of the definition.
  bool has(const std::string& definition, const std::string& key) const {
    return used_.contains(definition + "." + key);
  }

  /// True if some scene says `word` there.
  bool has_word(const std::string& definition, const std::string& key, const std::string& word) const {
    return used_.contains(definition + "." + key + "=" + word);
  }

  std::vector<std::string> keys(const std::string& definition) const {
    std::vector<std::string> keys;
    const YamlNode* properties = member(*definition_of(definition), "properties");
    for (std::size_t i = 0; i + 1 < properties->items.size(); i += 2)
      keys.push_back(properties->items[i]->text);
    return keys;
  }

  /// The name of the definition that says what `key` in a map of `definition` is.
  std::string definition_behind(const std::string& definition, const std::string& key) const {
    const YamlNode* value = member(*member(*definition_of(definition), "properties"), key);
    const YamlNode* reference = member(*value, "$ref");
    return reference ? name_of(*reference) : "";
  }

  /// The words that `key` in a map of `definition` may be.
  std::vector<std::string> words(const std::string& definition, const std::string& key) const {
    std::vector<std::string> words;
    collect_words(*member(*member(*definition_of(definition), "properties"), key), words);
    return words;
  }

 private:
  static std::string name_of(const YamlNode& reference) {
    return reference.text.substr(std::string("#/$defs/").size());
  }
  const YamlNode* definition_of(const std::string& name) const {
    return member(*member(*schema_.root, "$defs"), name);
  }

  void collect_words(const YamlNode& schema, std::vector<std::string>& words) const {
    if (const YamlNode* list = member(schema, "enum"))
      for (const YamlNode* word : list->items) words.push_back(word->text);
    if (const YamlNode* choices = member(schema, "anyOf"))
      for (const YamlNode* choice : choices->items) collect_words(*choice, words);
  }

  /// Takes note of a scene and of the scene files that it includes.
  void add(const fs::path& path) {
    YamlFile file;
    file.path = path.string(), file.text = test::file_content(path);
    parse_yaml(file, kMaxSceneNodes);
    look(*file.root, *schema_.root, "");
    if (const YamlNode* include = member(*file.root, "include"))
      for (const YamlNode* other : include->items)
        if (fs::path(other->text).extension() == ".yaml") add(path.parent_path() / other->text);
  }

  /// `name` says which key of which definition, or which definition, `schema` describes.
  void look(const YamlNode& node, const YamlNode& schema, const std::string& name) {
    if (const YamlNode* reference = member(schema, "$ref")) {
      const std::string target = name_of(*reference);
      return look(node, *definition_of(target), target);
    }
    if (const YamlNode* choices = member(schema, "anyOf"))
      for (const YamlNode* choice : choices->items) look(node, *choice, name);
    if (member(schema, "enum") != nullptr && node.kind == YamlKind::scalar)
      used_.insert(name + "=" + node.text);
    if (const YamlNode* items = member(schema, "items"); items && node.kind == YamlKind::sequence)
      for (const YamlNode* item : node.items) look(*item, *items, name);
    if (node.kind == YamlKind::map) look_into_map(node, schema, name);
  }

  void look_into_map(const YamlNode& node, const YamlNode& schema, const std::string& name) {
    const YamlNode* properties = member(schema, "properties");
    const YamlNode* others = member(schema, "additionalProperties");
    for (std::size_t i = 0; i + 1 < node.items.size(); i += 2) {
      // A map that fits another choice has keys that this one does not know.
      const YamlNode* value = properties ? member(*properties, node.items[i]->text) : nullptr;
      if (properties && !value) return;
    }
    for (std::size_t i = 0; i + 1 < node.items.size(); i += 2) {
      const std::string key = name + "." + node.items[i]->text;
      if (properties) {
        used_.insert(key);
        look(*node.items[i + 1], *member(*properties, node.items[i]->text), key);
      } else if (others && others->kind == YamlKind::map) {
        look(*node.items[i + 1], *others, name);
      }
    }
  }

  YamlFile schema_;
  std::set<std::string> used_;  ///< DEFINITION.KEY, and DEFINITION.KEY=WORD
};

class SceneGallery : public testing::Test {
 protected:
  // Made once for all tests, since parsing dozens of files takes time.
  static const Usage& usage_of_all() {
    static const Usage all;
    return all;
  }

  void expect_all_keys(const std::string& definition) const {
    for (const std::string& key : usage.keys(definition))
      // That of OpenVDB's grids would need the library, letters a font, which the project does not bring.
      EXPECT_TRUE(usage.has(definition, key) || key == "grid_name" || key == "text")
          << "no scene of the gallery has '" << key << "' in a " << definition;
  }

  const Usage& usage = usage_of_all();
};

TEST_F(SceneGallery, ListsScenes) {
  const std::vector<std::string> names = gallery_names();
  EXPECT_GE(names.size(), 30u);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size()) << "a scene stands twice";
}

/// Among the keys of an object are the shapes, and among those of a texture the patterns.
TEST_F(SceneGallery, ShowsEveryFamily) {
  for (const char* definition :
       {"scene", "camera", "medium", "material", "principled_material", "texture", "light", "object"}) {
    EXPECT_GE(usage.keys(definition).size(), 8u) << definition;
    expect_all_keys(definition);
  }
}

/// Each key that lights have, in some kind of light.
TEST_F(SceneGallery, ShowsWhatLightsHave) {
  std::set<std::string> keys;
  for (const std::string& kind : usage.keys("light"))
    for (const std::string& key : usage.keys(usage.definition_behind("light", kind))) keys.insert(key);
  EXPECT_GE(keys.size(), 20u);
  for (const std::string& key : keys) {
    bool found = false;
    for (const std::string& kind : usage.keys("light"))
      found |= usage.has(usage.definition_behind("light", kind), key);
    EXPECT_TRUE(found) << "no light of the gallery has '" << key << "'";
  }
}

TEST_F(SceneGallery, ShowsEveryNamedMetal) {
  const std::vector<std::string> metals = usage.words("principled_material", "metal");
  EXPECT_GE(metals.size(), 8u);
  for (const std::string& metal : metals)
    EXPECT_TRUE(usage.has_word("principled_material", "metal", metal)) << metal;
}

}  // namespace
}  // namespace oktett::scene_gallery_test
