#pragma once
/// \file Words of the command line that name one of several things.

#include <span>
#include <string>
#include <vector>

#include "core/description.h"
#include "core/error.h"

namespace oktett {

/// The choice that `word`, the value of `option`, names. Throws Error if there is none.
template <class T>
T choice_of(const char* option, const std::string& word, std::span<const Choice<T>> choices) {
  std::vector<const char*> names;
  std::string all;
  for (const Choice<T>& c : choices) {
    if (word == c.name) return c.value;
    all += (names.empty() ? "" : names.size() + 1 == choices.size() ? " or " : ", ") + std::string(c.name);
    names.push_back(c.name);
  }
  const std::string near = nearest_name(word, names.data(), names.size());
  throw Error(std::string(option) + ": unknown kind '" + word + "'; " +
              (near.empty() ? "expected " + all : "did you mean '" + near + "'?"));
}

}  // namespace oktett
