#include "io/yaml/error_list.h"

namespace oktett {

void ErrorList::count_failure() {
  if (++failures_ > kMostFailures) throw TooManyErrors{};
}

void ErrorList::add(const Error& error) {
  count_failure();
  const Location& at = error.where();
  // What an alias stands for is read again wherever the alias stands.
  if (at.line > 0 && !places_.emplace(at.file, at.line, at.column).second) return;
  errors_.push_back(error);
  if (errors_.size() >= kMostErrors) throw TooManyErrors{};
}

void ErrorList::add_if_first(const Error& error) {
  if (is_clean())
    add(error);
  else
    count_failure();
}

const YamlNode& ErrorList::missing_value(const YamlNode& map) {
  YamlNode& node = missing_.emplace_back();
  node.file = map.file;
  node.missing = true;
  node.line = map.line, node.column = map.column, node.offset = map.offset;
  return node;
}

void report(const YamlNode& node, const std::string& message) {
  const Error error(node.where(), message);
  if (node.file->errors == nullptr) throw error;
  node.file->errors->add(error);
}

}  // namespace oktett
