#include "io/threemf/lib3mf/components.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>

#include "core/error.h"
#include "io/threemf/model.h"

namespace oktett {
namespace {

/// An object: its part of the package and its id.
using ObjectKey = std::pair<std::string, std::string>;

/// The elements of the text of a model, as far as they matter here.
class ElementScanner {
 public:
  explicit ElementScanner(std::string_view text) : text_(text) {}

  /// Goes to the next place where an element begins or ends. False behind the last one, or where the text is
  /// no XML; then lib3mf says so.
  bool next() {
    for (;;) {
      at_ = text_.find('<', at_);
      if (at_ == std::string_view::npos) return false;
      if (skip("<!--", "-->") || skip("<![CDATA[", "]]>") || skip("<?", "?>") || skip("<!", ">")) continue;
      is_end = text_.substr(at_).starts_with("</");
      at_ += is_end ? 2 : 1;
      const std::size_t end = text_.find_first_of(" \t\r\n/>", at_);
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
    attribute = whole.substr(0, whole.find_last_not_of(" \t\r\n") + 1);
    value = text_.substr(quote + 1, end - quote - 1);
    at_ = end + 1;
    return true;
  }

  /// Whether the element ends where it begins. Asked behind its last attribute.
  bool is_empty() const { return at_ < text_.size() && text_[at_] == '/'; }

  std::string_view name;              ///< without its prefix
  bool is_end = false;                ///< the element ends here
  std::string_view attribute, value;  ///< with its prefix

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

  /// lib3mf knows namespaces, and this does not. So objects may not stand in objects, whatever their prefix,
  /// and a component with a path counts with each object that it may mean.
  void add(const std::string& part, std::string_view text) {
    ElementScanner scanner(text);
    if (!scanner.next() || scanner.name != "model") return;
    ObjectKey object;
    bool is_inside = false;
    std::set<std::string> begun;
    while (scanner.next()) {
      if (scanner.name == "object") {
        if (scanner.is_end) {
          is_inside = false;
          continue;
        }
        if (is_inside) fail("an object begins inside another one");
        object = {part, ""};
        while (scanner.next_attribute())
          if (scanner.attribute == "id") object.second = number(scanner.value);
        begun.insert(object.second);
        is_inside = !scanner.is_empty();
      } else if (scanner.name == "component" && !scanner.is_end) {
        std::vector<std::string> paths;
        std::string id;
        while (scanner.next_attribute()) {
          if (scanner.attribute == "objectid") id = number(scanner.value);
          if (scanner.attribute == "path" || scanner.attribute.ends_with(":path"))
            paths.push_back(part_at(scanner.value));
        }
        if (paths.empty() || begun.contains(id)) paths.push_back(part);
        for (std::string& path : paths) inner_[object].push_back({std::move(path), id});
      }
    }
  }

  void check() {
    for (const auto& [key, inner] : inner_) shown_by(key, 0);
  }

 private:
  [[noreturn]] void fail(const char* words) const {
    throw Error(Location{path_}, std::string("cannot be read as a 3MF file: ") + words);
  }

  std::string part_at(std::string_view path) const {
    if (path.find('&') != std::string_view::npos) fail("expected the path of a part without '&'");
    return std::string(path.substr(path.starts_with('/') ? 1 : 0));
  }

  /// An id as lib3mf understands it, which reads digits and what XML writes otherwise.
  std::string number(std::string_view text) const {
    if (text.find('&') != std::string_view::npos) fail("expected digits as the id of an object");
    const std::size_t first = text.find_first_not_of(" \t\r\n+0");
    if (first == std::string_view::npos) return "0";
    return std::string(text.substr(first, text.find_first_not_of("0123456789", first) - first));
  }

  std::uint64_t shown_by(const ObjectKey& key, int level) {
    if (level > kMostThreeMfLevels)
      throw Error(Location{path_},
                  "its components are nested deeper than " + std::to_string(kMostThreeMfLevels) + " levels");
    const auto found = inner_.find(key);
    if (found == inner_.end()) return 1;
    if (const auto known = shown_.find(key); known != shown_.end()) return known->second;
    std::uint64_t sum = 1;
    for (const ObjectKey& inner : found->second) {
      sum += shown_by(inner, level + 1);
      if (sum > kMostThreeMfShown)
        throw Error(Location{path_},
                    "its components show more than " + std::to_string(kMostThreeMfShown) + " objects");
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
