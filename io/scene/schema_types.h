#pragma once
/// \file What is known of the places of scene files, and how it is written as a JSON Schema. Within io/ only.

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "io/scene/read_probe.h"

namespace oktett {

/// One thing that may stand at a place: a value, a map with known keys, or a list or map of like entries.
struct SchemaType {
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::optional<ReadType> value;
  std::size_t map;                ///< index into SchemaTypes::maps, or kNone
  std::size_t entry;              ///< the place of the entries, or kNone
  std::set<std::size_t> lengths;  ///< that a list may have; empty: any
  bool names = false;             ///< the entries have names
  /// Least and greatest number of entries of a list, if the reader tells.
  std::optional<std::pair<double, double>> counts = {};
  bool operator==(const SchemaType&) const = default;
};

/// A place: the value of a key, or the entries of a list or of a map with any keys.
struct SchemaSlot {
  std::size_t parent = 0;  ///< index of the place of the map or list that it was found in
  std::string key;         ///< empty for entries
  std::vector<SchemaType> found;
  std::size_t beside = SchemaType::kNone;  ///< the place of a key that must stand beside this one to be read
};

/// A map with known keys, in the place of each.
struct SchemaMap {
  std::string what;
  std::vector<std::string> keys;
  std::vector<std::size_t> slots;  ///< per key
  std::set<std::string> required;
  std::vector<std::string> one_of;  ///< exactly one of these keys is given; empty: no such rule
};

struct SchemaTypes {
  std::vector<SchemaSlot> slots;  ///< the first is the whole file
  std::vector<SchemaMap> maps;
};

std::string schema_text(const SchemaTypes& types);

}  // namespace oktett
