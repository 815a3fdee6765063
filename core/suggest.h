#pragma once
/// \file What someone may have meant who wrote a name that does not exist.

#include <cstddef>
#include <span>
#include <string>

namespace oktett {

/// The least number of characters to insert, leave out or replace that makes `b` of `a`.
std::size_t edit_distance(const std::string& a, const std::string& b);

/// "; did you mean 'x'?" for the name in `known` that nearest_name finds for `name`, if they share a
/// letter. If there is none: "; " and `otherwise`, or nothing. Control characters of names are shown as `?`.
/// Looks at no more than 10,000 names.
std::string did_you_mean(const std::string& name, std::span<const std::string> known,
                         const std::string& otherwise = "");

}  // namespace oktett
