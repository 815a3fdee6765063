#pragma once
/// \file Words of the command line that name one of several things.

#include <span>
#include <string>
#include <vector>

#include "app/command_line.h"
#include "core/description.h"
#include "core/error.h"

namespace oktett {

/// The names of all choices.
template <class T>
std::vector<std::string> names_of(std::span<const Choice<T>> choices) {
  std::vector<std::string> names;
  for (const Choice<T>& c : choices) names.push_back(c.name);
  return names;
}

/// The choice that `word`, the value of `option`, names. Throws Error if there is none.
template <class T>
T choice_of(const char* option, const std::string& word, std::span<const Choice<T>> choices) {
  for (const Choice<T>& c : choices)
    if (word == c.name) return c.value;
  const std::vector<std::string> names = names_of(choices);
  throw Error(std::string(option) + ": unknown kind '" + word + "'" +
              did_you_mean(word, names, "expected " + or_list(names)));
}

}  // namespace oktett
