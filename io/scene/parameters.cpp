#include "io/scene/parameters.h"

#include <algorithm>
#include <utility>

#include "io/scene/values.h"
#include "io/yaml/utf8.h"

namespace oktett {

static bool is_name(const std::string& name) {
  const auto is_name_character = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !name.empty() && std::all_of(name.begin(), name.end(), is_name_character);
}

SceneParameters::SceneParameters(const Definitions& definitions) {
  for (const auto& [name, text] : definitions) {
    if (!is_name(name)) throw Error("-D " + name + ": a name consists of letters, digits, '_' and '-'");
    if (text.size() > kMaxExpandedScalar) throw Error("-D " + name + ": the value is too long");
    values_[name] = {text, true, false, false};
  }
}

void SceneParameters::add_defaults(const YamlNode& params) {
  const std::vector<MapEntry> entries = map_entries(params, "params");
  for (const auto& [key, value] : entries)
    if (!attempt(*key, [&, k = key, v = value] { add_default(*k, *v); }))
      values_.try_emplace(key->text, Value{"", false, false, true});
}

void SceneParameters::add_default(const YamlNode& key, const YamlNode& value) {
  const std::string& name = key.text;
  if (!is_name(name)) throw Error(key.where(), "a name consists of letters, digits, '_' and '-'");
  if (value.kind != YamlKind::scalar)
    throw Error(value.where(), "expected a number or text, found " + value.describe());
  std::string text = expand(value);
  const auto [place, is_new] = values_.try_emplace(name, Value{std::move(text), false, false, false});
  if (!is_new) place->second.used = true;
  if (values_.size() > kMaxParameters)
    throw Error(key.where(), "more than " + std::to_string(kMaxParameters) + " parameters");
}

const std::string& SceneParameters::lookup(const YamlNode& scalar, std::size_t at, const std::string& name) {
  const auto found = values_.find(name);
  if (found != values_.end()) {
    found->second.used = true;
    if (found->second.wrong) throw FollowingError();
    return found->second.text;
  }
  if (incomplete_) throw FollowingError();
  std::vector<std::string> names;
  for (const auto& entry : values_) names.push_back(entry.first);
  throw Error(scalar.where(at), "no value for " + quote("${" + name + "}") + suggest(name, names) +
                                    "; give one in 'params' or with -D");
}

std::string SceneParameters::expand(const YamlNode& scalar) {
  const std::string& text = scalar.text;
  if (text.find("${") == std::string::npos) {
    if (text.size() > kMaxExpandedScalar) throw Error(scalar.where(), "the value is too long");
    return text;
  }
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    if (text.compare(i, 3, "$${") == 0) {
      result += "${";
      i += 3;
    } else if (text.compare(i, 2, "${") == 0) {
      const std::size_t end = text.find('}', i);
      if (end == std::string::npos) throw Error(scalar.where(i), "'${' without '}'");
      result += lookup(scalar, i, text.substr(i + 2, end - i - 2));
      i = end + 1;
    } else {
      result += text[i++];
    }
    if (result.size() > kMaxExpandedScalar) throw Error(scalar.where(), "the value is too long");
  }
  return result;
}

std::vector<Warning> SceneParameters::unused() const {
  std::vector<std::string> known;
  for (const auto& [name, value] : values_)
    if (value.used || !value.from_command_line) known.push_back(name);
  std::vector<Warning> warnings;
  for (const auto& [name, value] : values_)
    if (value.from_command_line && !value.used)
      warnings.push_back(
          Warning{Location{}, "-D " + name + ": the scene has no ${" + name + "}" + suggest(name, known)});
  return warnings;
}

}  // namespace oktett
