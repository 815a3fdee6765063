#pragma once
/// \file Scenes in POV-Ray's language and what they become.

#include <string>

#include "core/error.h"
#include "io/pov/translate/translate.h"
#include "io/scene/pov_scene.h"
#include "io/scene/scene_file.h"
#include "io/yaml/write_yaml.h"
#include "tests/support/temp_dir.h"

namespace oktett::test {

/// Scenes as files of a folder.
class PovFiles {
 public:
  pov::TranslatedScene translate(const std::string& text) const {
    return read_pov_tree(dir.write("scene.pov", text), {}, {});
  }
  /// The value of a key of the top level in one line.
  std::string section(const std::string& text, const std::string& key) const {
    const pov::TranslatedScene scene = translate(text);
    for (std::size_t i = 0; i + 1 < scene.root->items.size(); i += 2)
      if (scene.root->items[i]->text == key) return flow_text(*scene.root->items[i + 1]);
    return "none";
  }
  /// The only object, whose look is `material` or nothing.
  std::string object(const std::string& text) const { return without_look(section(text, "objects")); }
  /// All warnings, a line each.
  std::string warnings(const std::string& text) const {
    std::string all;
    for (const Warning& w : translate(text).warnings) all += without_folder(to_string(w)) + "\n";
    return all;
  }
  std::string error(const std::string& text) const {
    try {
      load_scene(dir.write("scene.pov", text));
    } catch (const Error& e) {
      return without_folder(e.what());
    }
    return "no error";
  }

  TempDir dir;

 private:
  static std::string without_look(std::string text) {
    const std::string look = ", material: material";
    for (std::size_t at; (at = text.find(look)) != std::string::npos;) text.erase(at, look.size());
    if (text.starts_with("[") && text.ends_with("]")) text = text.substr(1, text.size() - 2);
    return text;
  }
  std::string without_folder(std::string text) const {
    const std::string folder = dir.path().string() + "/";
    for (std::size_t at; (at = text.find(folder)) != std::string::npos;) text.erase(at, folder.size());
    return text;
  }
};

}  // namespace oktett::test
