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
  std::vector<const char*> names;
  for (const Choice<T>& c : choices) {
    if (word == c.name) return c.value;
    names.push_back(c.name);
  }
  const std::string near = nearest_name(word, names.data(), names.size());
  throw Error(std::string(option) + ": unknown kind '" + word + "'; " +
              (near.empty() ? "expected " + or_list(names_of(choices)) : "did you mean '" + near + "'?"));
}

}  // namespace oktett
