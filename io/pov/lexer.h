#pragma once
/// \file Words, numbers, strings and signs of POV-Ray's language, read one after the other from a file in
/// memory. Nothing is kept of what was read: loops and macros read their text again.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "io/pov/document.h"
#include "io/pov/keywords.h"
#include "io/pov/value.h"
#include "io/text/file_content.h"

namespace oktett::pov {

/// A file whose text is in memory, with zero bytes behind it.
struct Source {
  /// `copied`: the file may change while the scene is read, so it must not stay mapped.
  Source(const std::string& path, std::uint32_t file, bool copied);

  std::optional<FileContent> content;
  std::string copy;
  std::string_view text;
  std::string path;
  std::uint32_t file;  ///< index into Document::files
  const char* end;     ///< of the text
};

/// Where reading goes on.
struct Cursor {
  const Source* source = nullptr;
  const char* p = nullptr;
  const char* line_start = nullptr;
  std::uint32_t line = 1;

  Place place() const {
    return {source->file, line, static_cast<std::uint32_t>(p - line_start) + 1, Place::kNoCall};
  }
};

/// Something that a name stands for, in the scope that declared it.
struct Binding {
  std::uint32_t scope;
  Reference value;
};

/// A word of the language or of the scene; one object for each spelling.
struct Name {
  std::string text;
  Keyword keyword = kNoKeyword;
  std::vector<Binding> bindings;  ///< the innermost last

  /// What it stands for; null if it is not declared.
  const Datum* datum() const { return bindings.empty() ? nullptr : bindings.back().value.find(); }
};

/// All names, those of the language from the start.
class Names {
 public:
  Names();
  Name& intern(std::string_view text);
  /// Those that are declared, for "did you mean".
  std::vector<std::string> declared() const;

 private:
  std::unordered_map<std::string_view, std::unique_ptr<Name>> names_;
};

struct Token {
  enum class Kind : std::uint8_t {
    end,     ///< of the scene
    number,  ///< `number`
    string,  ///< `text` is what stands between the quotes
    word,    ///< `name`
    sign,    ///< `sign`; `#` starts a directive
    held,    ///< a directive that has to wait until the value before it has been declared
  };
  Kind kind = Kind::end;
  char sign = 0;
  double number = 0;
  std::string_view text;
  Name* name = nullptr;
  Place where;

  bool is(char wanted) const { return kind == Kind::sign && sign == wanted; }
  Keyword keyword() const { return kind == Kind::word ? name->keyword : kNoKeyword; }
};

/// Past blanks, line ends and comments. Throws LexError.
void skip_space(Cursor& at);

/// The decimal number at `p`, which starts with a digit or a point and a digit. Returns its end.
const char* scan_number(const char* p, const char* end, double& value);

/// The token at `at`, which stands behind skip_space, becomes `token`; words are interned. Throws LexError.
void lex(Cursor& at, Names& names, Token& token);

/// A mistake in the text that hides where its tokens are.
struct LexError {
  Cursor where;
  std::string message;
};

/// How a token reads in a message, such as "'sphere'" or "the end of the file".
std::string describe(const Token& token);

/// "; did you mean ...?", or nothing if none of `known` is similar.
std::string similar(const std::string& name, const std::vector<std::string>& known);

/// `text` in quotes, without control characters, cut short if it is long.
std::string in_quotes(std::string_view text);

/// Text that is read again takes as long as one step for so many bytes.
inline constexpr std::size_t kBytesOfStep = 32;

inline bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace oktett::pov
