#pragma once
/// \file Loading scenes from text, for the tests of scene files.

#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

#include "io/scene/scene_file.h"
#include "tests/support/temp_dir.h"

namespace oktett::test {

/// A directory with files for one test.
class SceneFiles {
 public:
  /// Writes `text` as scene.yaml and loads it.
  Scene load(const std::string& text, const Definitions& definitions = {}) const {
    return load_scene_file(dir.write("scene.yaml", text), definitions);
  }
  /// The same with the version line in front.
  Scene load_v1(const std::string& text, const Definitions& definitions = {}) const {
    return load("oktett: 1\n" + text, definitions);
  }

  /// The error message without the directory's path, or "no error".
  std::string error(const std::string& text, const Definitions& definitions = {}) const {
    try {
      load(text, definitions);
    } catch (const Error& e) {
      return without_directory(e.what());
    }
    return "no error";
  }
  /// The same with the version line in front, so that `text` begins in line 2.
  std::string error_v1(const std::string& text, const Definitions& definitions = {}) const {
    return error("oktett: 1\n" + text, definitions);
  }

  /// The warnings of a scene, a line each. `text` begins in line 2.
  std::string warnings_v1(const std::string& text) const {
    std::string all;
    for (const Warning& w : load_v1(text).warnings) all += without_directory(to_string(w)) + "\n";
    return all;
  }

  std::string without_directory(std::string message) const {
    const std::string prefix = dir.path().string() + "/";
    for (std::size_t at; (at = message.find(prefix)) != std::string::npos;) message.erase(at, prefix.size());
    return message;
  }

  TempDir dir;
};

/// `part` stands at the start of `message`.
inline void expect_starts(const std::string& message, const std::string& part) {
  EXPECT_EQ(message.substr(0, part.size()), part) << "the whole: " << message;
}

/// A scene, without its version line, and how the error starts that it must give.
struct WrongScene {
  std::string text, error;
};
inline void expect_errors(const std::vector<WrongScene>& scenes) {
  const SceneFiles files;
  for (const WrongScene& scene : scenes) {
    SCOPED_TRACE(scene.text.substr(0, 100));
    expect_starts(files.error_v1(scene.text), scene.error);
  }
}

/// An object that has no surface, how the first warning starts that it must give, and how many there are.
struct SkippedObject {
  std::string object, warning;
  std::size_t warnings = 1;
};
inline void expect_skipped(const std::vector<SkippedObject>& objects) {
  const SceneFiles files;
  for (const SkippedObject& skipped : objects) {
    SCOPED_TRACE(skipped.object);
    const Scene scene = files.load_v1("objects: [ {" + skipped.object + "}, {sphere: {}}]\n");
    EXPECT_EQ(scene.objects.size(), 1u);
    ASSERT_EQ(scene.warnings.size(), skipped.warnings);
    expect_starts(files.without_directory(to_string(scene.warnings[0])), skipped.warning);
  }
}

/// The shape of object i, which must be a T.
template <class T>
const T& shape_of(const Scene& scene, std::size_t i = 0) {
  return std::get<T>(scene.objects.at(i).shape);
}

}  // namespace oktett::test
