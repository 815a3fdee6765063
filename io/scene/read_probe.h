#pragma once
/// \file Watches what the readers of scene files ask of a tree. Within io/ only.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/description.h"

namespace oktett {

struct YamlNode;

/// What a reader takes a value for.
struct ReadType {
  enum class Kind : std::uint8_t { number, integer, boolean, text, file, choice, color, numbers };
  Kind kind;
  Range range{};                     ///< of each number
  std::size_t count = 0;             ///< of the numbers in a list
  std::vector<std::string> words{};  ///< of a choice
  std::string pattern{};             ///< of a text: a regular expression; empty: any text
  bool operator==(const ReadType& other) const {
    return kind == other.kind && range.lo == other.range.lo && range.hi == other.range.hi &&
           range.lo_open == other.range.lo_open && range.hi_open == other.range.hi_open &&
           count == other.count && words == other.words && pattern == other.pattern;
  }
};

/// A number in the range.
double some_number(const Range& range);

/// The watcher of a tree that stands for files in general, see YamlFile::probe. Values in such a tree are not
/// looked at: whatever stands there counts as allowed.
class ReadProbe {
 public:
  virtual ~ReadProbe() = default;
  /// A scalar or list is read as this.
  virtual void value(const YamlNode& node, const ReadType& type) = 0;
  /// A map is read that may have these keys; `what` names it.
  virtual void keys(const YamlNode& map, const std::string& what, const std::vector<std::string>& known) = 0;
  /// A map or a list is read whose entries are all alike. It may turn out to be a map with known keys.
  virtual void entries(const YamlNode& node, const std::string& what) = 0;
  /// A list that was read has so many entries.
  virtual void count(const YamlNode& list, const Range& counts) = 0;
  /// A map that was read has exactly one of these keys.
  virtual void one_of(const YamlNode& map, const std::vector<std::string>& keys) = 0;
  /// A value that the map must have, but does not: one is made up.
  virtual const YamlNode& required(const YamlNode& map, const char* key) = 0;
  /// Makes up the numbers of a list.
  virtual void fill(std::span<double> list, const Range& range) = 0;
  /// Which of its words a choice stands for.
  virtual std::size_t chosen(std::size_t words) const = 0;
};

}  // namespace oktett
