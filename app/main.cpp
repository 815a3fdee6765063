#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <new>
#include <optional>

#include "app/command_line.h"
#include "core/error.h"

namespace oktett {
namespace {

constexpr int kExitInternal = 3;

/// An error with a location begins with it, so that editors can jump there.
void print_error(const Error& error) {
  const char* prefix = error.where().file.empty() ? "oktett: " : "";
  fmt::print(stderr, "{}{}\n", prefix, error.what());
}

int run(int argc, char** argv) {
  CommandLine line(argc, argv);
  add_render_command(line);
  add_info_command(line);
  add_merge_command(line);
  add_verify_command(line);
  if (const std::optional<int> status = line.parse()) return *status;
  try {
    return line.run();
  } catch (const Error& error) {
    print_error(error);
    return error.kind() == ErrorKind::io ? kExitIo : kExitBadInput;
  }
}

}  // namespace
}  // namespace oktett

int main(int argc, char** argv) {
  try {
    return oktett::run(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fputs("oktett: out of memory\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "oktett: internal error: %s\n", error.what());
  }
  return oktett::kExitInternal;
}
