#include "io/pov/lexer.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "io/text/number.h"
#include "io/text/scan.h"

namespace oktett::pov {

Source::Source(const std::string& of_path, std::uint32_t of_file, bool copied)
    : content(of_path), text(content->text()), path(of_path), file(of_file) {
  if (copied) {
    const std::size_t size = text.size();
    copy = text;
    copy.append(FileContent::kPadding, '\0');
    content.reset();
    text = std::string_view(copy).substr(0, size);
  }
  text = without_byte_order_mark(text);
  end = text.data() + text.size();
}

/// Names that are longer are compared with no others: that would take too long.
static constexpr std::size_t kLongestSimilar = 100;

Names::Names() {
  for (std::size_t i = 0; i < kKeywords.size(); ++i) intern(kKeywords[i]).keyword = static_cast<Keyword>(i);
}

Name& Names::intern(std::string_view text) {
  if (const auto found = names_.find(text); found != names_.end()) return *found->second;
  auto name = std::make_unique<Name>();
  name->text = text;
  Name& result = *name;
  names_.emplace(result.text, std::move(name));
  return result;
}

std::vector<std::string> Names::declared() const {
  std::vector<std::string> result;
  for (const auto& [text, name] : names_)
    if (!name->bindings.empty() && text.size() <= kLongestSimilar) result.emplace_back(text);
  std::sort(result.begin(), result.end());
  return result;
}

/// Past `/* ... */`, in which others may stand.
static void skip_comment(Cursor& at) {
  const Cursor start = at;
  const char* const end = at.source->end;
  std::uint32_t depth = 0;
  for (const char* p = at.p; p < end; ++p) {
    if (p[0] == '/' && p[1] == '*') {
      ++depth, ++p;
    } else if (p[0] == '*' && p[1] == '/') {
      ++p;
      if (--depth > 0) continue;
      at.p = p + 1;
      return;
    } else if (*p == '\n') {
      ++at.line;
      at.line_start = p + 1;
    }
  }
  throw LexError{start, "the comment that starts here has no end"};
}

void skip_space(Cursor& at) {
  for (;;) {
    const char* p = at.p;
    while (*p == ' ' || *p == '\t') ++p;
    at.p = p;
    switch (*p) {
      case '\n':
        at.p = at.line_start = p + 1;
        ++at.line;
        continue;
      case '\r':
        at.p = p + 1;
        if (p[1] != '\n') {
          at.line_start = at.p;
          ++at.line;
        }
        continue;
      case '\f':
      case '\v':
      case '\x1a':  // old editors end files with it
        at.p = p + 1;
        continue;
      case '/':
        if (p[1] == '/') {
          while (p < at.source->end && *p != '\n' && *p != '\r') ++p;
          at.p = p;
          continue;
        }
        if (p[1] != '*') return;
        skip_comment(at);
        continue;
      default:
        return;
    }
  }
}

const char* scan_number(const char* p, const char* end, double& value) {
  // The padding behind a text allows the reading of whole words.
  const char* const begin = p;
  std::uint64_t significand = 0;
  const char* q = detail::scan_digits(p, significand);
  std::ptrdiff_t digits = q - p;
  int exponent = 0;
  if (*q == '.') {
    const char* const fraction = q + 1;
    q = detail::scan_digits(fraction, significand);
    exponent = static_cast<int>(std::max<std::ptrdiff_t>(fraction - q, -1000));
    digits += q - fraction;
  }
  const bool has_exponent =
      (*q | 0x20) == 'e' && (is_digit(q[1]) || ((q[1] == '-' || q[1] == '+') && is_digit(q[2])));
  if (!has_exponent && digits <= 19 && significand <= (std::uint64_t{1} << 53) && exponent >= -22) {
    // Both are exact, so the quotient is the nearest double.
    value = static_cast<double>(significand) / detail::kExactPower10[-exponent];
    return q;
  }
  if (has_exponent) {
    q += is_digit(q[1]) ? 1 : 2;
    while (is_digit(*q)) ++q;
  }
  const auto [stop, error] = std::from_chars(begin, std::min(q, end), value);
  if (error == std::errc::result_out_of_range) {
    // Too small becomes 0, too large infinite.
    const char* const e = std::find_if(begin, q, [](char c) { return (c | 0x20) == 'e'; });
    const bool tiny = e == q ? std::all_of(begin, q, [](char c) { return c == '0' || c == '.'; }) ||
                                   std::find(begin, q, '.') - begin < 300
                             : e[1] == '-';
    value = tiny ? 0 : HUGE_VAL;
  }
  return q;
}

static void lex_string(Cursor& at, Token& token) {
  const Cursor start = at;
  const char* const begin = at.p + 1;
  for (const char* p = begin; p < at.source->end; ++p) {
    if (*p == '"') {
      token.kind = Token::Kind::string;
      token.text = {begin, static_cast<std::size_t>(p - begin)};
      at.p = p + 1;
      return;
    }
    if (*p == '\\') ++p;
    if (*p == '\n') {
      ++at.line;
      at.line_start = p + 1;
    }
  }
  throw LexError{start, "the string that starts here has no end"};
}

/// Signs of the language.
static constexpr std::array<bool, 256> kSigns = [] {
  std::array<bool, 256> result{};
  for (const char c : std::string_view("#{}[]()<>,;+-*/.=!&|?:"))
    result[static_cast<unsigned char>(c)] = true;
  return result;
}();

void lex(Cursor& at, Names& names, Token& token) {
  token.where = at.place();
  const char* const p = at.p;
  if (is_letter(*p)) {
    const char* q = p + 1;
    while (is_letter(*q) || is_digit(*q)) ++q;
    token.kind = Token::Kind::word;
    token.name = &names.intern({p, static_cast<std::size_t>(q - p)});
    at.p = q;
  } else if (is_digit(*p) || (*p == '.' && is_digit(p[1]))) {
    token.kind = Token::Kind::number;
    at.p = scan_number(p, at.source->end, token.number);
  } else if (kSigns[static_cast<unsigned char>(*p)]) {
    token.kind = Token::Kind::sign;
    token.sign = *p;
    at.p = p + 1;
  } else if (*p == '"') {
    lex_string(at, token);
  } else if (p >= at.source->end) {
    token.kind = Token::Kind::end;
    at.p = at.source->end;
  } else {
    throw LexError{at, "unexpected character " + in_quotes({p, 1})};
  }
}

std::string similar(const std::string& name, const std::vector<std::string>& known) {
  return name.size() <= kLongestSimilar ? did_you_mean(name, known) : "";
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t most = 60;
  std::string result = "'";
  for (const char c : text.substr(0, most)) {
    const auto code = static_cast<unsigned char>(c);
    result += code < 32 || code == 127 ? '?' : c;
  }
  return result + (text.size() > most ? "...'" : "'");
}

std::string describe(const Token& token) {
  switch (token.kind) {
    case Token::Kind::end:
      return "the end of the file";
    case Token::Kind::number: {
      char text[32];
      return "the number " + std::string(text, std::to_chars(text, text + sizeof text, token.number).ptr);
    }
    case Token::Kind::string:
      return "the string " + in_quotes(token.text);
    case Token::Kind::word:
      return in_quotes(token.name->text);
    case Token::Kind::sign:
      return in_quotes({&token.sign, 1});
    case Token::Kind::held:
      break;
  }
  return "a directive";
}

}  // namespace oktett::pov
