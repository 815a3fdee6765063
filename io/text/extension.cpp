#include "io/text/extension.h"

#include <cctype>
#include <filesystem>

namespace oktett {

std::string lower_case_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

bool is_packed(const std::string& path) { return lower_case_extension(path) == ".gz"; }

std::string without_packing(const std::string& path) {
  return is_packed(path) ? path.substr(0, path.size() - 3) : path;
}

}  // namespace oktett
