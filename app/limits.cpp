#include "app/limits.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <system_error>

#include "app/text.h"
#include "core/error.h"
#include "io/image/output.h"
#include "io/text/files.h"

namespace oktett {
namespace {

/// Private memory that can be written to, and not the whole address space: files that are mapped for reading,
/// and address space that allocators only reserve, take no memory.
void limit_memory(std::uint64_t bytes) {
  rlimit limit{};
  getrlimit(RLIMIT_DATA, &limit);
  if (bytes >= limit.rlim_cur) return;
  limit.rlim_cur = bytes;
  if (setrlimit(RLIMIT_DATA, &limit) != 0)
    throw Error(fmt::format("--max-memory: {}", std::generic_category().message(errno)), ErrorKind::io);
}

void on_time_up(int) {
  constexpr char kLine[] = "oktett: --timeout: the time is up before there is anything to keep\n";
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kLine, sizeof kLine - 1);
  remove_unfinished_files();
  _exit(kExitTimeout);
}

void limit_time(double seconds) {
  std::signal(SIGALRM, &on_time_up);
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(seconds);
  timer.it_value.tv_usec = static_cast<suseconds_t>((seconds - std::floor(seconds)) * 1e6);
  setitimer(ITIMER_REAL, &timer, nullptr);
}

}  // namespace

std::uint64_t parse_bytes(const char* option, const std::string& text) {
  std::uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  int shift = 0;
  if (rest + 1 == end) shift = *rest == 'K' ? 10 : *rest == 'M' ? 20 : *rest == 'G' ? 30 : -1;
  const bool good = error == std::errc{} && rest + 1 >= end && shift >= 0 && number > 0;
  if (!good || number > UINT64_MAX >> shift)
    throw Error(fmt::format("{}: '{}' is no number of bytes such as 800000000, 800M or 4G", option, text));
  return number << shift;
}

void add_limit_options(Verb& verb, LimitArguments& a) {
  verb.option("--max-memory", &a.memory, "BYTES", "Most memory to use, e.g. 800M or 4G");
  verb.option("--timeout", &a.seconds, "SECONDS", "Most time to take; what is finished then is kept");
  verb.option("--root", &a.root, "DIR", "Read no files outside of this folder");
}

void apply_limits(const LimitArguments& arguments) {
  const std::uint64_t bytes = arguments.memory.empty() ? 0 : parse_bytes("--max-memory", arguments.memory);
  const double seconds =
      arguments.seconds.empty() ? 0 : parse_amount("--timeout", arguments.seconds, "seconds", 1e-3, 1e8);
  if (!arguments.root.empty()) confine_files(arguments.root);
  if (bytes > 0) limit_memory(bytes);
  if (seconds > 0) limit_time(seconds);
}

}  // namespace oktett
