#include "io/scene_exact.h"

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
        superquadric_readers(), metaball_readers()})
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
