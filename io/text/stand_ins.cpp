#include "io/text/stand_ins.h"

#include <mutex>
#include <utility>

namespace oktett {
namespace {

std::mutex stand_in_mutex;
std::map<std::string, std::string> stand_ins;

}  // namespace

StandIns::StandIns(std::map<std::string, std::string> files) {
  const std::lock_guard lock(stand_in_mutex);
  stand_ins = std::move(files);
}

StandIns::~StandIns() {
  const std::lock_guard lock(stand_in_mutex);
  stand_ins.clear();
}

std::string path_to_open(const std::string& path) {
  const std::lock_guard lock(stand_in_mutex);
  const auto found = stand_ins.find(path);
  return found == stand_ins.end() ? path : found->second;
}

}  // namespace oktett
