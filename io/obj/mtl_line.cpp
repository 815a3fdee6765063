#include "io/obj/mtl_line.h"

#include <cmath>

#include "io/mesh/failure.h"
#include "io/text/number.h"

namespace oktett {

MtlLine::MtlLine(const char* p, const std::string& path, LineCounter& lines, std::vector<Warning>& warnings)
    : start_(p), next_(p), path_(path), lines_(lines), warnings_(warnings), keyword_(take()) {
  for (char& c : keyword_)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
}

std::string_view MtlLine::peek() const { return word_at(next_word(next_)); }

std::string_view MtlLine::take() {
  const std::string_view word = peek();
  next_ = word.data() + word.size();
  return word;
}

std::string MtlLine::take_rest() {
  // Unlike elsewhere, a `#` may be part of a name.
  next_ = skip_blanks(next_);
  std::string rest;
  for (;;) {
    const LineShape line = measure_line(next_);
    const bool joint = line.end > next_ && line.ends_in_joint();
    rest += trimmed(next_, line.end - (joint ? 1 : 0));
    next_ = line.end;
    if (!joint || *line.end == '\0') return rest;
    next_ = skip_line_end(line.end);
    rest += ' ';
  }
}

bool MtlLine::has_more_than_one_word() const { return count_words(next_) > 1; }

std::optional<float> MtlLine::take_number_if_any() {
  const char* p = next_word(next_);
  NumberProblem problem = NumberProblem::none;
  float value = 0;
  const char* end = is_line_end(*p) ? nullptr : scan_float(p, value, problem);
  if (end == nullptr || !std::isfinite(value)) return std::nullopt;
  next_ = end;
  return value;
}

std::optional<float> MtlLine::take_number() {
  const std::optional<float> value = take_number_if_any();
  if (value) return value;
  const std::string_view word = peek();
  warn(word.empty() ? "expected a number, found the end of the line"
                    : "expected a finite number, found " + quote_word(word.data()));
  return std::nullopt;
}

std::optional<Color> MtlLine::take_color() {
  const std::string_view word = peek();
  if (word == "spectral" || word == "xyz") {
    warn(quote_name(word) + " colours are not supported; the default is kept");
    return std::nullopt;
  }
  const std::optional<float> r = take_number();
  if (!r) return std::nullopt;
  const bool grey = peek().empty();
  const std::optional<float> g = grey ? r : take_number();
  const std::optional<float> b = grey ? r : g ? take_number() : std::nullopt;
  if (!b) return std::nullopt;
  if (*r >= 0 && *g >= 0 && *b >= 0) return Color{*r, *g, *b};
  warn("a colour has a negative part; it counts as 0");
  return max(Color{*r, *g, *b}, Color{0, 0, 0});
}

Location MtlLine::where() const {
  const TextPosition line = lines_.at(start_);
  return {path_, line.line, line.column};
}

void MtlLine::warn(const std::string& message) const {
  // Past the end of the keyword, so that the position is where reading stopped.
  const TextPosition line = lines_.at(start_);
  const char* p = next_word(next_);
  const int column = p >= start_ ? line.column + static_cast<int>(p - start_) : line.column;
  warnings_.push_back({Location{path_, line.line, column}, message});
}

}  // namespace oktett
