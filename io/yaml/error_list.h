#pragma once
/// \file All that is wrong in a scene, where the first error would end the reading otherwise. Within io/
/// only.

#include <cstddef>
#include <deque>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/yaml/yaml.h"

namespace oktett {

/// An error that follows from another one, which is known already. Thrown only where errors are gathered.
class FollowingError : public Error {
 public:
  FollowingError() : Error("an error before this one") {}
};

/// Thrown when so much is wrong that looking for more is a waste of time. No Error, so that nobody goes on.
struct TooManyErrors {};

/// Gathers errors. Readers call attempt() for what can be wrong by itself: a value, an item of a list, a
/// section. A value that cannot be read is made up, and an error that may come from made-up values is left
/// out: one that ends an attempt counts only if all before it in the same attempt was right.
class ErrorList {
 public:
  static constexpr std::size_t kMostErrors = 1000;
  /// Errors that are left out counted in.
  static constexpr std::size_t kMostFailures = 10000;

  /// Calls `read` and keeps the Error that ends it. Returns whether it came to its end.
  template <class Read>
  bool attempt(const Read& read) {
    const std::size_t outer = std::exchange(start_, failures_);
    const Restore restore{start_, outer};
    try {
      read();
      return true;
    } catch (const FollowingError&) {
      count_failure();
    } catch (const Error& error) {
      add_if_first(error);
    }
    return false;
  }

  /// Keeps an error, but only the first of its place.
  void add(const Error& error);
  /// The same if all was right so far in this attempt.
  void add_if_first(const Error& error);
  /// Whether all was right so far in this attempt.
  bool is_clean() const { return failures_ == start_; }
  /// How often something was wrong, errors that are left out counted in.
  std::size_t failures() const { return failures_; }

  /// Stands for the value that `map` must have, but does not.
  const YamlNode& missing_value(const YamlNode& map);

  /// In the order in which they were found.
  const std::vector<Error>& errors() const { return errors_; }

 private:
  struct Restore {
    std::size_t& start;
    std::size_t outer;
    ~Restore() { start = outer; }
  };

  void count_failure();

  std::size_t failures_ = 0;
  std::size_t start_ = 0;  ///< of failures_, when the innermost attempt began
  std::vector<Error> errors_;
  std::set<std::tuple<std::string, int, int>> places_;
  std::deque<YamlNode> missing_;
};

/// Throws an Error at `node`. Where errors are gathered, keeps it and returns instead.
void report(const YamlNode& node, const std::string& message);

/// Calls `read`, which is an attempt if errors are gathered. Returns whether it came to its end.
template <class Read>
bool attempt(ErrorList* errors, const Read& read) {
  if (errors != nullptr) return errors->attempt(read);
  read();
  return true;
}
/// The same for what is read of `node`.
template <class Read>
bool attempt(const YamlNode& node, const Read& read) {
  return attempt(node.file->errors, read);
}

/// What `read` returns, or what `make_up` does after an error that was kept.
template <class Read, class MakeUp>
auto read_or(const YamlNode& node, const Read& read, const MakeUp& make_up) {
  ErrorList* const errors = node.file->errors;
  if (errors == nullptr) return read();
  std::optional<decltype(read())> value;
  if (!node.missing) errors->attempt([&] { value.emplace(read()); });
  return value ? std::move(*value) : make_up();
}

}  // namespace oktett
