#include "io/threemf/lib3mf/components.h"

#include <cstddef>
#include <cstdint>
#include <map>

#include "core/error.h"

namespace oktett {
namespace {

constexpr std::uint64_t kMostShown = 1'000'000;
constexpr int kMostNested = 64;

/// An object: its part of the package and its id.
using ObjectKey = std::pair<std::string, std::string>;

/// The elements of the text of a model, as far as they matter here.
class ElementScanner {
 public:
  explicit ElementScanner(std::string_view text) : text_(text) {}

  /// Goes to the next element that begins. False behind the last one, or where the text is no XML; then
  /// lib3mf says so.
  bool next() {
    for (;;) {
      at_ = text_.find('<', at_);
      if (at_ == std::string_view::npos) return false;
      if (skip("<!--", "-->") || skip("<![CDATA[", "]]>") || skip("<?", "?>") || skip("<!", ">")) continue;
      const std::size_t end = text_.find_first_of(" \t\r\n/>", ++at_);
      if (end == std::string_view::npos) return false;
      name = local(text_.substr(at_, end - at_));
      at_ = end;
      if (!name.empty()) return true;
    }
  }

  /// Goes to the next attribute of the element; false if there is none.
  bool next_attribute() {
    at_ = text_.find_first_not_of(" \t\r\n", at_);
    if (at_ == std::string_view::npos || text_[at_] == '>' || text_[at_] == '/') return false;
    const std::size_t equals = text_.find('=', at_);
    if (equals == std::string_view::npos) return false;
    const std::size_t quote = text_.find_first_of("\"'", equals);
    if (quote == std::string_view::npos) return false;
    const std::size_t end = text_.find(text_[quote], quote + 1);
    if (end == std::string_view::npos) return false;
    const std::string_view whole = text_.substr(at_, equals - at_);
    attribute = local(whole.substr(0, whole.find_last_not_of(" \t\r\n") + 1));
    value = text_.substr(quote + 1, end - quote - 1);
    at_ = end + 1;
    return true;
  }

  std::string_view name, attribute, value;  ///< names without prefixes

 private:
  static std::string_view local(std::string_view name) { return name.substr(name.find(':') + 1); }

  bool skip(std::string_view begin, std::string_view end) {
    if (!text_.substr(at_).starts_with(begin)) return false;
    const std::size_t found = text_.find(end, at_ + begin.size());
    at_ = found == std::string_view::npos ? text_.size() : found + end.size();
    return true;
  }

  const std::string_view text_;
  std::size_t at_ = 0;
};

class Components {
 public:
  explicit Components(const std::string& path) : path_(path) {}

  void add(const std::string& part, std::string_view text) {
    ElementScanner scanner(text);
    ObjectKey object;
    while (scanner.next()) {
      const bool is_object = scanner.name == "object";
      if (!is_object && scanner.name != "component") continue;
      ObjectKey key{part, ""};
      while (scanner.next_attribute()) {
        if (scanner.attribute == (is_object ? "id" : "objectid")) key.second = number(scanner.value);
        if (scanner.attribute == "path" && !is_object)
          key.first = scanner.value.substr(scanner.value.starts_with('/') ? 1 : 0);
      }
      if (is_object)
        object = key;
      else
        inner_[object].push_back(key);
    }
  }

  void check() {
    for (const auto& [key, inner] : inner_) shown_by(key, 0);
  }

 private:
  /// An id as lib3mf understands it, which reads digits and what XML writes otherwise.
  std::string number(std::string_view text) const {
    if (text.find('&') != std::string_view::npos)
      throw Error(Location{path_}, "cannot be read as a 3MF file: expected digits as the id of an object");
    const std::size_t first = text.find_first_not_of(" \t\r\n+0");
    if (first == std::string_view::npos) return "0";
    return std::string(text.substr(first, text.find_first_not_of("0123456789", first) - first));
  }

  std::uint64_t shown_by(const ObjectKey& key, int level) {
    if (level > kMostNested)
      throw Error(Location{path_},
                  "its components are nested deeper than " + std::to_string(kMostNested) + " levels");
    const auto found = inner_.find(key);
    if (found == inner_.end()) return 1;
    if (const auto known = shown_.find(key); known != shown_.end()) return known->second;
    std::uint64_t sum = 1;
    for (const ObjectKey& inner : found->second) {
      sum += shown_by(inner, level + 1);
      if (sum > kMostShown)
        throw Error(Location{path_},
                    "its components show more than " + std::to_string(kMostShown) + " objects");
    }
    shown_[key] = sum;
    return sum;
  }

  const std::string& path_;
  std::map<ObjectKey, std::vector<ObjectKey>> inner_;
  std::map<ObjectKey, std::uint64_t> shown_;
};

}  // namespace

void check_components(const std::string& path,
                      const std::vector<std::pair<std::string, std::string>>& parts) {
  Components components(path);
  for (const auto& [name, text] : parts) components.add(name, text);
  components.check();
}

}  // namespace oktett
