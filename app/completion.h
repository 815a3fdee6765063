#pragma once
/// \file Completion of words for shells, made from the descriptions of the verbs.

#include <string>
#include <vector>

#include "app/command_line.h"

namespace oktett {

/// The shells that completion_script() knows.
inline constexpr const char* kShells[] = {"bash", "zsh", "fish"};

/// A script that the shell reads to complete the words after `oktett`. Throws Error for other shells.
std::string completion_script(const std::vector<VerbText>& verbs, const std::string& shell);

}  // namespace oktett
