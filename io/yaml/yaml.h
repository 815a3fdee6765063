#pragma once
/// \file A YAML file as an immutable tree with the place of every node. Within io/ only; knows nothing of
/// scenes.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "core/error.h"

namespace oktett {

/// What a file may ask for, so that no file exhausts the stack, memory or patience.
inline constexpr int kMaxYamlNesting = 100;  ///< maps and lists inside each other, aliases followed

enum class YamlKind : std::uint8_t { null, scalar, sequence, map };

struct YamlFile;
class ErrorList;

/// One node. A map's `items` alternate between keys (scalars, all different) and values. Aliases share the
/// node they name.
struct YamlNode {
  const YamlFile* file = nullptr;
  YamlKind kind = YamlKind::null;
  bool quoted = false;       ///< a scalar in quotes or a block scalar
  bool missing = false;      ///< stands for a value that is missing, see ErrorList
  std::uint32_t line = 0;    ///< from 1
  std::uint32_t column = 0;  ///< in characters, from 1
  std::uint32_t offset = 0;  ///< in bytes, from the start of the file's text
  std::string text;          ///< of a scalar, escapes resolved
  std::vector<const YamlNode*> items;

  Location where() const;
  /// Where byte `i` of a scalar's text stands in the file; the scalar's start if it is written in more than
  /// one line or with escapes.
  Location where(std::size_t i) const;
  /// "a map", "a list", "nothing" or the scalar in quotes, shortened.
  std::string describe() const;
};

/// A file that holds exactly one document. Not movable: nodes point to it.
struct YamlFile {
  std::string path;
  std::string text;
  std::deque<YamlNode> nodes;
  const YamlNode* root = nullptr;
  ErrorList* errors = nullptr;     ///< where errors are gathered; null: the first one is thrown
  std::size_t expanded_nodes = 0;  ///< number of nodes with each alias counted as what it stands for

  YamlFile() = default;
  YamlFile(const YamlFile&) = delete;
  YamlFile& operator=(const YamlFile&) = delete;
};

/// Why `path` cannot be read as a regular file, e.g. "no such file"; empty if it can.
std::string why_unreadable(const std::string& path);

/// The bytes of a regular file. Throws Error (ErrorKind::io) if it cannot be read, (bad_input) if it is
/// longer than `max_bytes`.
std::string read_text_file(const std::string& path, std::size_t max_bytes);

/// Parses `file.text`, which has been read from `file.path`, into `file.root`. Throws Error with line and
/// column for text that is not UTF-8 or not YAML, tags, keys that are no scalars or appear twice, no or
/// several documents, and for more than `max_nodes` nodes or deeper nesting than kMaxYamlNesting.
void parse_yaml(YamlFile& file, std::size_t max_nodes);

}  // namespace oktett
