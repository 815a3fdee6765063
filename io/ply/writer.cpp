#include <algorithm>
#include <string_view>

#include "io/ply/ply.h"
#include "io/text/file_content.h"

namespace oktett {

bool is_ply_of_blender(const std::string& path) {
  constexpr std::size_t kMostHeader = 1 << 16;
  const FileContent content(path);
  std::string_view header = content.text().substr(0, kMostHeader);
  header = header.substr(0, header.find("end_header"));
  while (!header.empty()) {
    const std::string_view line = header.substr(0, header.find_first_of("\r\n"));
    if (line.starts_with("comment") && line.find("Blender") != std::string_view::npos) return true;
    header.remove_prefix(std::min(header.size(), line.size() + 1));
  }
  return false;
}

}  // namespace oktett
