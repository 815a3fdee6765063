#pragma once
/// \file Files that are read in place of others: scenes whose files exist in memory only.

#include <map>
#include <string>

namespace oktett {

/// While an object of this class exists, whoever reads the file `first` of an entry reads the file `second`.
/// Messages and FilesRead name the first. For the whole process; only one may exist at a time.
class StandIns {
 public:
  explicit StandIns(std::map<std::string, std::string> files);
  ~StandIns();
  StandIns(const StandIns&) = delete;
  StandIns& operator=(const StandIns&) = delete;
};

/// The path of the file that is opened for `path`: that of its stand-in, or `path` itself. Threads may call
/// it at the same time.
std::string path_to_open(const std::string& path);

}  // namespace oktett
