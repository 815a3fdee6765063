#include "core/suggest.h"

#include <algorithm>
#include <vector>

#include "core/error.h"

namespace oktett {

std::string did_you_mean(const std::string& name, std::span<const std::string> known,
                         const std::string& otherwise) {
  // Enough for names that people write; a machine's million names would take too long to compare.
  constexpr std::size_t kMostNames = 10000;
  std::vector<const char*> names;
  for (const std::string& k : known.first(std::min(known.size(), kMostNames))) names.push_back(k.c_str());
  std::string nearest = nearest_name(name, names.data(), names.size());
  // A name that shares no letter with it was not meant.
  if (edit_distance(name, nearest) >= name.size()) nearest.clear();
  if (nearest.empty()) return otherwise.empty() ? "" : "; " + otherwise;
  for (char& c : nearest)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
  return "; did you mean '" + nearest + "'?";
}

}  // namespace oktett
