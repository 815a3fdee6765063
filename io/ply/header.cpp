#include "io/ply/header.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/text/number.h"

namespace oktett {
namespace {

constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes{{
    {"char", PlyType::int8},
    {"int8", PlyType::int8},
    {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},
    {"short", PlyType::int16},
    {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},
    {"uint16", PlyType::uint16},
    {"int", PlyType::int32},
    {"int32", PlyType::int32},
    {"uint", PlyType::uint32},
    {"uint32", PlyType::uint32},
    {"float", PlyType::float32},
    {"float32", PlyType::float32},
    {"double", PlyType::float64},
    {"float64", PlyType::float64},
}};

/// Elements, and properties of each.
constexpr std::size_t kMostParts = 1000;

class HeaderReader {
 public:
  explicit HeaderReader(std::string_view text) : next_(text.data()), text_end_(text.data() + text.size()) {}

  PlyHeader run() {
    take_line();
    if (words_.size() != 1 || words_[0] != "ply")
      stop_at(line_, "expected 'ply', which begins a PLY file, found " + found_word(0));
    const bool cr_only = line_end_[0] == '\r' && line_end_[1] != '\n';
    do take_line();
    while (read_line());
    if (!format_) stop_at(line_, "expected a line 'format' before the end of the header");
    header_.format = *format_;
    // Bytes that look like an end of line may begin the body.
    header_.body = cr_only && *line_end_ == '\r' ? line_end_ + 1 : next_;
    // A text that another program put behind a header of its own.
    if (*format_ == PlyFormat::ascii)
      header_.body = without_byte_order_mark({header_.body, text_end_}).data();
    return std::move(header_);
  }

 private:
  void take_line() {
    if (next_ >= text_end_) stop_at(text_end_, "the header does not end; expected 'end_header'");
    line_ = next_;
    line_end_ = find_line_end(line_);
    if (*line_end_ == '\0' && line_end_ < text_end_) stop_at(line_end_, "unexpected zero byte in the header");
    next_ = next_line(line_end_, text_end_);
    words_.clear();
    for (const char* p = line_; p < line_end_;) {
      while (p < line_end_ && is_blank(*p)) ++p;
      const char* begin = p;
      while (p < line_end_ && !is_blank(*p)) ++p;
      if (p > begin) words_.emplace_back(begin, static_cast<std::size_t>(p - begin));
    }
  }

  /// Returns whether the header goes on.
  bool read_line() {
    if (words_.empty() || words_[0] == "obj_info") return true;
    if (words_[0] == "comment") return note_texture();
    if (words_[0] == "end_header") {
      expect_words(1, "end_header");
      return false;
    }
    if (words_[0] == "format")
      read_format();
    else if (words_[0] == "element")
      read_element();
    else if (words_[0] == "property")
      read_property();
    else
      skip_line();
    return true;
  }

  /// Some programs write comments without the word. What looks like a misspelled keyword is none.
  void skip_line() {
    const std::string word(words_[0].substr(0, 64));
    const std::vector<std::string> known{"comment", "obj_info", "format",
                                         "element", "property", "end_header"};
    const bool is_text = (word[0] >= 'a' && word[0] <= 'z') || (word[0] >= 'A' && word[0] <= 'Z');
    if (!is_text || !did_you_mean(word, known).empty())
      stop_at(words_[0].data(),
              "expected 'comment', 'obj_info', 'format', 'element', 'property' or 'end_header', found " +
                  quote_name(word));
    note(
        "the line is not read; expected 'comment', 'obj_info', 'format', 'element', 'property' or "
        "'end_header'");
  }

  void note(std::string words) {
    if (header_.notices.size() < kMostParts) header_.notices.push_back({line_, std::move(words)});
  }

  /// What MeshLab says of the image that texture coordinates refer to.
  bool note_texture() {
    if (words_.size() < 3 || words_[1] != "TextureFile" || header_.textures.size() == kMostParts) return true;
    const char* const begin = words_[2].data();
    header_.textures.emplace_back(begin, static_cast<std::size_t>(words_.back().end() - begin));
    return true;
  }

  std::string found_word(std::size_t i) const {
    if (i >= words_.size()) return "the end of the line";
    return quote_word(words_[i].data());
  }

  void expect_words(std::size_t count, const char* pattern) const {
    if (words_.size() == count) return;
    const char* where = words_.size() > count ? words_[count].data() : line_end_;
    stop_at(where,
            std::string("expected '") + pattern + "', found " + found_word(std::min(count, words_.size())));
  }

  void read_format() {
    expect_words(3, "format KIND 1.0");
    if (format_) stop_at(line_, "a second line 'format'");
    if (words_[1] == "ascii")
      format_ = PlyFormat::ascii;
    else if (words_[1] == "binary_little_endian")
      format_ = PlyFormat::little_endian;
    else if (words_[1] == "binary_big_endian")
      format_ = PlyFormat::big_endian;
    else
      stop_at(words_[1].data(),
              "expected 'ascii', 'binary_little_endian' or 'binary_big_endian', found " + found_word(1));
    if (words_[2] != "1.0") stop_at(words_[2].data(), "expected version 1.0, found " + found_word(2));
  }

  void read_element() {
    expect_words(3, "element NAME COUNT");
    PlyElement element;
    element.name = words_[1];
    element.where = line_;
    if (header_.find(element.name) != nullptr)
      stop_at(words_[1].data(), "a second element " + quote_name(element.name));
    const char* const p = words_[2].data();
    const char* const end = scan_whole(p, element.count);
    if (end == p || end != p + words_[2].size())
      stop_at(p, "expected the number of elements, found " + found_word(2));
    if (header_.elements.size() == kMostParts)
      stop_at(line_, "more than " + std::to_string(kMostParts) + " elements");
    header_.elements.push_back(std::move(element));
  }

  void read_property() {
    if (header_.elements.empty()) stop_at(line_, "expected an 'element' before its properties");
    PlyProperty property;
    property.where = line_;
    property.is_list = words_.size() > 1 && words_[1] == "list";
    if (property.is_list) {
      expect_words(5, "property list LENGTH_TYPE TYPE NAME");
      property.length_type = type_at(2);
      if (!is_whole(property.length_type))
        stop_at(words_[2].data(), "the length of a list is a whole number, found " + found_word(2));
      property.type = type_at(3);
    } else {
      expect_words(3, "property TYPE NAME");
      property.type = type_at(1);
    }
    property.name = words_.back();
    PlyElement& element = header_.elements.back();
    if (element.find({property.name}) != PlyElement::kNone)
      note("element " + quote_name(element.name) + " has a second property " + quote_name(property.name) +
           "; the first counts");
    if (element.properties.size() == kMostParts)
      stop_at(line_, "more than " + std::to_string(kMostParts) + " properties");
    element.properties.push_back(property);
  }

  PlyType type_at(std::size_t i) const {
    const auto found = std::ranges::find(kTypes, words_[i], &std::pair<std::string_view, PlyType>::first);
    if (found != kTypes.end()) return found->second;
    stop_at(words_[i].data(), words_[i] == "list"
                                  ? std::string("a list of lists is not allowed")
                                  : "unknown type " + found_word(i) +
                                        "; expected char, uchar, short, ushort, int, uint, float or double");
  }

  PlyHeader header_;
  std::optional<PlyFormat> format_;
  const char* next_;
  const char* const text_end_;
  const char* line_ = nullptr;
  const char* line_end_ = nullptr;
  std::vector<std::string_view> words_;
};

}  // namespace

int PlyElement::find(std::initializer_list<std::string_view> names) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (std::ranges::find(names, properties[i].name) != names.end()) return static_cast<int>(i);
  return kNone;
}

bool PlyElement::has_lists() const { return std::ranges::any_of(properties, &PlyProperty::is_list); }

std::size_t PlyElement::least_bytes() const {
  std::size_t bytes = 0;
  for (const PlyProperty& p : properties) bytes += size_of(p.is_list ? p.length_type : p.type);
  return bytes;
}

const PlyElement* PlyHeader::find(std::string_view name) const {
  const auto found = std::ranges::find(elements, name, &PlyElement::name);
  return found == elements.end() ? nullptr : &*found;
}

PlyHeader read_ply_header(std::string_view text) { return HeaderReader(text).run(); }

}  // namespace oktett
