#include "io/scene_exact.h"

#include <iterator>

namespace oktett {
namespace {

using MaybeForm = std::optional<ExactForm>;

/// Warns that the object is left out because of `reason`.
std::nullopt_t skip(SceneLoad& load, const YamlNode& place, const std::string& reason) {
  load.warn(place.where(), reason + "; the object is skipped");
  return std::nullopt;
}

MaybeForm read_torus(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  const Fields fields(node, "torus", {"major", "minor", "normals"});
  TorusShape shape;
  load.values.read(fields["major"], shape.major, kNonNegative);
  load.values.read(fields["minor"], shape.minor, kNonNegative);
  if (shape.minor == 0) return skip(load, key, "the minor radius is zero");
  return shape;
}

struct Reader {
  const char* key;
  MaybeForm (*read)(SceneLoad&, const YamlNode& key, const YamlNode& node);
};

/// Every reader takes the key `normals` too, which is read here.
constexpr Reader kReaders[] = {{"torus", read_torus}};

}  // namespace

std::vector<std::string> exact_keys() {
  std::vector<std::string> keys;
  for (const Reader& reader : kReaders) keys.push_back(reader.key);
  return keys;
}

std::optional<ExactShape> read_exact(SceneLoad& load, const YamlNode& key, const YamlNode& node,
                                     bool& known) {
  for (const Reader& reader : kReaders) {
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
