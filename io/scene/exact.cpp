#include "io/scene/exact.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/scene/utf8.h"

namespace oktett {
namespace {

using MaybeForm = std::optional<ExactForm>;

MaybeForm read_torus(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "torus", {"major", "minor", "normals"});
  TorusShape shape;
  load.values.read(fields["major"], shape.major, kNonNegative);
  load.values.read(fields["minor"], shape.minor, kNonNegative);
  if (shape.minor == 0) return skip_exact(load, key, "the minor radius is zero");
  return shape;
}

constexpr ExactReader kReaders[] = {{"torus", read_torus}};

std::vector<ExactReader> all_readers() {
  std::vector<ExactReader> all;
  for (const std::span<const ExactReader> family :
       {std::span<const ExactReader>(kReaders), closed_form_readers(), polynomial_readers(),
        superquadric_readers(), metaball_readers(), function_readers(), fractal_readers(), height_readers()})
    all.insert(all.end(), family.begin(), family.end());
  return all;
}

const std::vector<ExactReader>& readers() {
  static const std::vector<ExactReader> all = all_readers();
  return all;
}

}  // namespace

std::nullopt_t skip_exact(SceneLoad& load, const YamlNode& place, const std::string& reason) {
  load.warn(place.where(), reason + "; the object is skipped");
  return std::nullopt;
}

void fail_in_text(const char* what, const YamlNode& node, const std::string& text, const Error& error) {
  const auto at = std::min(static_cast<std::size_t>(error.where().column) - 1, text.size());
  std::string message = fmt::format("bad {}: {} (column {})", what, error.what(), error.where().column);
  // The part of a long text around the place.
  const std::size_t begin = at > 100 ? at - 100 : 0, length = std::min<std::size_t>(text.size() - begin, 200);
  if (text.find('\n') == std::string::npos && character_count(text) == text.size())
    message += fmt::format("\n  {}\n  {}^", text.substr(begin, length), std::string(at - begin, ' '));
  throw Error(text == node.text ? node.where(at) : node.where(), message);
}

void read_bounds(SceneLoad& load, const YamlNode& node, Vec3d& lo, Vec3d& hi) {
  const Fields fields(node, "bounds", {"min", "max"});
  lo = load.values.vector(fields.require("min")), hi = load.values.vector(fields.require("max"));
  for (int k = 0; k < 3; ++k)
    if (!(lo[k] < hi[k]))
      throw Error(fields.require("max").where(),
                  fmt::format("the {} of max must be greater than that of min", "xyz"[k]));
}

std::vector<std::string> exact_keys() {
  std::vector<std::string> keys;
  for (const ExactReader& reader : readers()) keys.push_back(reader.key);
  return keys;
}

std::optional<ExactShape> read_exact(SceneLoad& load, const YamlNode& key, const YamlNode& node,
                                     bool& known) {
  for (const ExactReader& reader : readers()) {
    if (key.text != reader.key) continue;
    known = true;
    const MaybeForm form = reader.read(load, key, node);
    if (!form) return std::nullopt;
    ExactShape shape{*form};
    if (node.kind == YamlKind::map) {
      const auto entries = map_entries(node, key.text);
      for (const MapEntry& entry : entries)
        if (entry.key->text == "normals")
          shape.normals =
              load.values.choice<NormalMethod>(*entry.value, {{"gradient", NormalMethod::gradient},
                                                              {"forward", NormalMethod::forward},
                                                              {"central", NormalMethod::central}});
    }
    return shape;
  }
  known = false;
  return std::nullopt;
}

}  // namespace oktett
