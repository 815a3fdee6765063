#pragma once
/// \file Errors and warnings: what is wrong, where, what was expected, and what may have been meant.

#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>

namespace oktett {

/// A place in a text file. Lines and columns count from 1; 0 means unknown and is left out of the message.
struct Location {
  std::string file;
  int line = 0;
  int column = 0;

  bool operator==(const Location&) const = default;
};

/// `file`, `file:line` or `file:line:column`.
std::string to_string(const Location& where);

/// What went wrong. The command exits with 2 for bad input and with 1 for failed input or output.
enum class ErrorKind {
  bad_input,  ///< arguments, or what a file says
  io,         ///< reading or writing
};

/// What the library throws, apart from std::bad_alloc. `what()` is one line: `FILE:LINE:COLUMN: message`, or
/// just the message if there is no file.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message, ErrorKind kind = ErrorKind::bad_input);
  Error(Location where, const std::string& message, ErrorKind kind = ErrorKind::bad_input);

  const Location& where() const { return where_; }
  ErrorKind kind() const { return kind_; }

 private:
  Location where_;
  ErrorKind kind_;
};

/// A problem that does not stop the work: the thing at `where` was skipped or given a default.
struct Warning {
  Location where;
  std::string message;
};

/// `FILE:LINE:COLUMN: warning: message`.
std::string to_string(const Warning& warning);

/// The name in `known` nearest to `name` by edit distance, for "did you mean"; empty if none is near.
std::string nearest_name(const std::string& name, const char* const* known, std::size_t known_count);

/// The least number of characters to insert, leave out or replace that makes `b` of `a`.
std::size_t edit_distance(const std::string& a, const std::string& b);

/// "; did you mean 'x'?" for the name in `known` that nearest_name finds for `name`, if they share a
/// letter. If there is none: "; " and `otherwise`, or nothing. Control characters of names are shown as `?`.
/// Looks at no more than 10,000 names.
std::string did_you_mean(const std::string& name, std::span<const std::string> known,
                         const std::string& otherwise = "");

/// "fast, balanced or best", and "fast, balanced and best".
std::string or_list(std::span<const std::string> words);
std::string and_list(std::span<const std::string> words);

}  // namespace oktett
