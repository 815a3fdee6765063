#include "app/view/private_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <system_error>

#include "core/error.h"

namespace oktett {

PrivateFolder::PrivateFolder() {
  std::error_code error;
  std::string pattern = (std::filesystem::temp_directory_path(error) / "oktett-XXXXXX").string();
  if (error || mkdtemp(pattern.data()) == nullptr)
    throw Error("no temporary folder can be made", ErrorKind::io);
  path_ = pattern;
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path PrivateFolder::write(std::string_view name, std::string_view content) const {
  const std::filesystem::path file = path_ / name;
  const int to = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  const bool written =
      to >= 0 && ::write(to, content.data(), content.size()) == static_cast<ssize_t>(content.size());
  if (to >= 0) close(to);
  if (!written) throw Error(fmt::format("{}: cannot be written", file.string()), ErrorKind::io);
  return file;
}

}  // namespace oktett
