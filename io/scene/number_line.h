#pragma once
/// \file Lines of numbers in text files beside a scene. Within io/ only.

#include <functional>
#include <string>
#include <string_view>

#include "io/scene/load.h"

namespace oktett {

/// The numbers of one line, parted by blanks; '#' begins a comment.
class NumberLine {
 public:
  /// `expected` says what a line holds, e.g. "4 numbers (x y z radius)".
  NumberLine(std::string_view line, const Location& place, const char* expected);

  const Location& place() const { return place_; }
  /// Whether nothing is left.
  bool empty() const { return at_ == line_.size() || line_[at_] == '#'; }
  /// The next number. Throws Error if there is none or it is out of range.
  double number();
  /// Throws Error if something is left.
  void finish() const;
  /// Throws Error at the number that was read last.
  [[noreturn]] void reject(const std::string& message) const { fail(previous_, message); }

 private:
  void skip_space();
  [[noreturn]] void fail(std::size_t at, const std::string& message) const;

  std::string_view line_;
  const Location& place_;
  const char* expected_;
  std::size_t at_ = 0, previous_ = 0;
};

/// Calls `read` for each line with numbers in the file that `node` names. `expected` is as above. Throws
/// Error if the file has more than `max_bytes`, or all such files of the scene, which `files` names, more
/// than kMaxSphereFileBytes.
void read_number_file(SceneLoad& load, const YamlNode& node, std::size_t max_bytes, const char* files,
                      const char* expected, const std::function<void(NumberLine&)>& read);

}  // namespace oktett
