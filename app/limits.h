#pragma once
/// \file What a run may use, for services that render scenes of strangers: memory, time, folders.

#include <cstdint>
#include <string>

#include "app/command_line.h"

namespace oktett {

/// The words of --max-memory, --timeout and --root; empty: no limit.
struct LimitArguments {
  std::string memory;
  std::string seconds;
  std::string root;
};

/// Exit status after --timeout, as of the command `timeout`.
inline constexpr int kExitTimeout = 124;

/// "1500000", "512M" and the like, in bytes. Throws Error that names the option.
std::uint64_t parse_bytes(const char* option, const std::string& text);

void add_limit_options(Verb& verb, LimitArguments& arguments);

/// From here on the process gets no more memory than said, reads no other files, and ends when the time since
/// this call is up, unless a StopOnSignal exists then. Throws Error for words that cannot be read and for a
/// folder that does not exist.
void apply_limits(const LimitArguments& arguments);

}  // namespace oktett
