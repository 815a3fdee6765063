#pragma once
/// \file Numbers with units, for people.

#include <cstdint>
#include <string>

namespace oktett {

/// "950", "12.3 k", "4.56 M", "7.89 G": three digits and a decimal prefix.
std::string with_prefix(double value);
/// "12.3 MB"; decimal prefixes.
inline std::string bytes_text(std::uint64_t bytes) { return with_prefix(static_cast<double>(bytes)) + "B"; }
/// "1,234,567".
std::string grouped(std::uint64_t value);
/// "0.123 s", "12.3 s", "2 min 05 s", "3 h 07 min".
std::string duration_text(double seconds);

}  // namespace oktett
