#pragma once
/// \file Whether files have changed, by asking for their times and sizes.

#include <map>
#include <string>
#include <vector>

namespace oktett {

class WatchedFiles {
 public:
  /// Watches these from now on.
  void watch(const std::vector<std::string>& paths);
  /// Whether any has changed since `watch` or the last call that said so.
  bool have_changed();

 private:
  std::map<std::string, std::string> seen_;  ///< what was found, by path
};

}  // namespace oktett
