#pragma once
/// \file How much memory the machine has to give.

#include <cstdint>
#include <string>

namespace oktett {

/// Bytes that the process can still take without memory being swapped out or the process being ended: what
/// the system calls available (MemAvailable of /proc/meminfo), and what the control groups that the process
/// is in leave (memory.max of version 2, memory.limit_in_bytes of version 1). The greatest number where
/// nothing is known.
std::uint64_t available_memory();

/// The same from other files: `meminfo` instead of /proc/meminfo, `self` instead of /proc/self/cgroup, and
/// the control groups below `groups` instead of /sys/fs/cgroup.
std::uint64_t available_memory(const std::string& meminfo, const std::string& self,
                               const std::string& groups);

/// In powers of a thousand, e.g. "14.5 GB".
std::string memory_text(std::uint64_t bytes);

}  // namespace oktett
