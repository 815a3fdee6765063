#pragma once
/// \file Manual pages for `man`, made from the descriptions of the verbs.

#include <string>
#include <vector>

#include "app/command_line.h"

namespace oktett {

/// The page oktett(1), or oktett-VERB(1), as troff with the macros of man(7). Throws Error if there is no
/// such verb.
std::string manual_page(const std::vector<VerbText>& verbs, const std::string& verb);

}  // namespace oktett
