/// \file What the table of shapes says is what the reader of scene files accepts.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <variant>
#include <vector>

#include "io/scene/described.h"
#include "io/scene/surface_table.h"
#include "tests/io/scene_test_support.h"

namespace oktett::scene_surface_table_test {
namespace {

using test::SceneFiles;
using Type = DescribedParameter::Type;
using Values = std::map<std::string, std::string>;

std::string usual_words(const DescribedParameter& p) {
  return p.usual == "required" || p.usual == "none" ? "" : p.usual;
}

/// A value for each parameter whose default is no value.
std::string sample(const std::string& surface, const DescribedParameter& p) {
  static const Values kSamples = {
      {"mesh.file", "a.obj"},
      {"mesh.stroke_width", "0.1"},
      {"metaballs.file", "balls.txt"},
      {"metaballs.balls", "[{}]"},
      {"metaballs.elements", "[{point: [0, 0, 0]}]"},
      {"height_field.function", "x * z"},
      {"polygon.vertices", "[[0, 0, 0], [1, 0, 0], [0, 1, 0]]"},
      {"polygon.holes", "[[[0.1, 0.1, 0], [0.2, 0.1, 0], [0.1, 0.2, 0]]]"},
      {"polyhedron.planes",
       "[[1, 0, 0, 1], [-1, 0, 0, 1], [0, 1, 0, 1], [0, -1, 0, 1], [0, 0, 1, 1], "
       "[0, 0, -1, 1]]"},
      {"polynomial.equation", "x^2 + y^2 + z^2 = 1/2"},
      {"implicit.function", "x^2 + y^2 + z^2 - 1/2"},
      {"blob.sources", "[{point: [0, 0, 0]}]"},
      {"revolution.points", "[[1, -1], [1, 0], [1, 1], [1, 2]]"},
      {"sphere_sweep.spheres", "[[0, 0, 0, 1], [1, 0, 0, 1], [2, 0, 0, 1], [3, 0, 0, 1]]"},
      {"bezier_patch.patches",
       "[[[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [0, 1, 0], [1, 1, 1], [2, 1, 1], [3, 1, 0], "
       "[0, 2, 0], [1, 2, 1], [2, 2, 1], [3, 2, 0], [0, 3, 0], [1, 3, 0], [2, 3, 0], [3, 3, 0]]]"},
      {"parametric.x", "u"},
      {"parametric.y", "v"},
      {"parametric.z", "u * v"},
      {"text.font", "font.ttf"},
      {"text.text", "a"},
      {"prism.outlines", "[[[0, 0], [1, 0], [0, 1], [0, 0]]]"},
      {"ifs.maps", "[{scale: 0.5}]"},
      {"height_field.base", "-2"}};
  if (const auto found = kSamples.find(surface + "." + p.parameter.key); found != kSamples.end())
    return found->second;
  const std::string key = p.parameter.key;
  if (surface == "blobtree" && p.usual == "none") return "[{point: [0, 0, 0]}]";
  if (key == "bounds" || key == "clip") return "{min: [-1, -1, -1], max: [1, 1, 1]}";
  return usual_words(p);
}

/// What every map of the shape needs.
Values needed(const DescribedSurface& s) {
  static const std::map<std::string, std::string> kOneOf = {
      {"metaballs", "balls"}, {"height_field", "function"}, {"blobtree", "sum"}};
  const auto one = kOneOf.find(s.surface.key);
  Values values;
  for (const DescribedParameter& p : s.parameters)
    if (p.usual == "required" || (one != kOneOf.end() && p.parameter.key == one->second))
      values[p.parameter.key] = sample(s.surface.key, p);
  return values;
}

/// The map with one more value, instead of what may not stand beside it.
Values with(const DescribedSurface& s, Values values, const std::string& key, const std::string& value) {
  const std::string surface = s.surface.key;
  const bool is_source =
      key == "file" || key == "elements" || key == "max" || key == "min" || key == "difference";
  if (is_source && surface != "mesh" && surface != "box") values.clear();
  values[key] = value;
  return values;
}

std::string object(const DescribedSurface& s, const Values& values) {
  std::string text = fmt::format("objects:\n  - {}:\n", s.surface.key);
  for (const auto& [key, value] : values) text += fmt::format("      {}: {}\n", key, value);
  return text;
}

/// Whether the shape needs a font, which FreeType reads if it is there (scene_text_test.cpp).
bool needs_font(const DescribedSurface& s) { return s.surface.key == std::string("text"); }

class SurfaceTable : public testing::Test {
 protected:
  SurfaceTable() {
    files.dir.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    files.dir.write("balls.txt", "0 0 0 1\n");
  }
  /// What is wrong with the shape, or "no error".
  std::string error(const DescribedSurface& s, const Values& values) const {
    return files.error_v1(object(s, values));
  }

  SceneFiles files;
};

TEST_F(SurfaceTable, IsInTheDocument) {
  const std::string document = test::file_content(OKTETT_SOURCE_DIR "/docs/scene-format.md");
  EXPECT_NE(document.find("\n\n" + surface_table() + "\n"), std::string::npos)
      << "expected the output of `oktett info --shapes` in docs/scene-format.md";
}

TEST_F(SurfaceTable, ThePatternsAreInTheDocument) {
  const std::string document = test::file_content(OKTETT_SOURCE_DIR "/docs/scene-format.md");
  EXPECT_NE(document.find("\n\n" + pattern_table() + "\n"), std::string::npos)
      << "expected the output of `oktett info --patterns` in docs/scene-format.md";
}

TEST_F(SurfaceTable, EveryListedKeyIsAccepted) {
  for (const DescribedSurface& s : described_surfaces()) {
    if (needs_font(s)) continue;
    EXPECT_EQ(error(s, needed(s)), "no error") << s.surface.key;
    for (const DescribedParameter& p : s.parameters) {
      // The heights of a grey image are read by the library of images, which is tested elsewhere.
      if (s.surface.key == std::string("height_field") && p.parameter.key == std::string("file")) continue;
      const std::string value = sample(s.surface.key, p);
      EXPECT_NE(value, "") << s.surface.key << "." << p.parameter.key;
      EXPECT_EQ(error(s, with(s, needed(s), p.parameter.key, value)), "no error")
          << s.surface.key << "." << p.parameter.key;
    }
  }
}

// An error for an unknown key lists the known ones.
TEST_F(SurfaceTable, NoOtherKeyIsAccepted) {
  for (const DescribedSurface& s : described_surfaces()) {
    const std::string message = error(s, {{"qqqqqqqq", "1"}});
    std::string keys;
    for (const DescribedParameter& p : s.parameters)
      keys += fmt::format("{}{}", keys.empty() ? "" : ", ", p.parameter.key);
    const std::string known = "known are ";
    ASSERT_NE(message.find(known), std::string::npos) << message;
    EXPECT_EQ(message.substr(message.find(known) + known.size()), keys);
  }
}

TEST_F(SurfaceTable, RangesEndWhereTheyAreSaidTo) {
  int ranges = 0;
  for (const DescribedSurface& s : described_surfaces())
    for (const DescribedParameter& p : s.parameters) {
      const bool is_vector = p.text.starts_with("3 lengths");
      if (p.type == Type::other && !is_vector) continue;
      ++ranges;
      const auto refuses = [&](double x) {
        const std::string number = fmt::format("{}", x);
        const std::string value = is_vector ? fmt::format("[1, {}, 1]", number) : number;
        const std::string message = error(s, with(s, needed(s), p.parameter.key, value));
        // Other errors are of how values go together.
        return message.find("expected a") != std::string::npos ||
               message.find("out of range") != std::string::npos ||
               message.find("must not be negative") != std::string::npos;
      };
      const Range& r = p.parameter.range;
      SCOPED_TRACE(fmt::format("{}.{}", s.surface.key, p.parameter.key));
      const double step = p.type == Type::whole_number ? 1 : 1e-12;
      EXPECT_EQ(refuses(r.lo), r.lo_open);
      EXPECT_EQ(refuses(r.hi), r.hi_open);
      EXPECT_TRUE(refuses(r.lo - std::max(step, 1e-12 * std::abs(r.lo))));
      EXPECT_TRUE(refuses(r.hi + std::max(step, 1e-12 * std::abs(r.hi))));
      EXPECT_FALSE(refuses(r.lo + std::max(step, 1e-12 * std::abs(r.lo))));
      EXPECT_FALSE(refuses(r.hi - std::max(step, 1e-12 * std::abs(r.hi))));
    }
  EXPECT_GT(ranges, 20);
}

/// The values of the parameters of a shape, of those kinds that can be compared.
class ValueList : public ParameterVisitor<ValueList> {
 public:
  template <class T>
  bool visit(const Parameter& p, T& value) {
    if constexpr (std::is_arithmetic_v<T>)
      values[p.key] = {static_cast<double>(value)};
    else if constexpr (std::is_same_v<T, Vec3d>)
      values[p.key] = {value.x, value.y, value.z};
    else if constexpr (std::is_same_v<T, ClipBox>)
      values[p.key] = {value.lo.x, value.lo.y, value.lo.z, value.hi.x, value.hi.y, value.hi.z};
    return false;
  }
  template <class T>
  bool visit(const Parameter& p, ChoiceOf<T>& choice) {
    values[p.key] = {static_cast<double>(choice.value)};
    return false;
  }
  void normals() {}

  std::map<std::string, std::vector<double>> values;
};

/// Compares what is read from files with what the data starts from.
struct Defaults {
  const SceneFiles& files;
  std::vector<DescribedSurface> table = described_surfaces();
  int compared = 0;

  template <class T>
  void surface(const ShapeInfo& surface, T start) {
    const auto is_this = [&](const DescribedSurface& s) { return s.surface.key == std::string(surface.key); };
    const DescribedSurface& s = *std::find_if(table.begin(), table.end(), is_this);
    if (needs_font(s)) return;
    Values values = needed(s);
    for (const DescribedParameter& p : s.parameters)
      if (const std::string usual = usual_words(p); !usual.empty()) values[p.parameter.key] = usual;
    for (const Values& given : {needed(s), values}) {
      const Scene scene = files.load_v1(object(s, given));
      ASSERT_EQ(scene.objects.size(), 1u) << surface.key;
      compare(start, scene.objects[0].shape, surface.key);
    }
  }

  template <class T>
  void compare(T start, const Shape& shape, const char* key) {
    const auto check = [&](auto found) {
      if constexpr (std::is_same_v<decltype(found), T>) {
        ValueList expected, read;
        start.describe(expected), found.describe(read);
        for (const auto& [name, value] : expected.values) {
          ASSERT_EQ(read.values[name].size(), value.size());
          for (std::size_t i = 0; i < value.size(); ++i, ++compared)
            EXPECT_NEAR(read.values[name][i], value[i], 1e-5) << key << "." << name;
        }
      }
    };
    std::visit(
        [&](const auto& plain) {
          if constexpr (std::is_same_v<decltype(plain), const ExactShape&>)
            std::visit(check, plain.form);
          else
            check(plain);
        },
        shape);
  }
};

// Both where nothing is given and where what the table says is the default is given.
TEST_F(SurfaceTable, DefaultsAreThoseOfTheData) {
  Defaults defaults{files};
  visit_surfaces(defaults);
  EXPECT_GT(defaults.compared, 150);
}

}  // namespace
}  // namespace oktett::scene_surface_table_test
