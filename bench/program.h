#pragma once
/// \file What the programs beside the benchmarks share: options, errors and files.

#include <charconv>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "core/error.h"

namespace oktett::bench {

/// One option of a program.
struct Option {
  const char* name;   ///< "--threads"
  const char* value;  ///< what the usage text calls its value; empty: it stands alone
  const char* help;
  std::function<void(const std::string& value)> set;  ///< throws Error for what it does not know
};

/// `head` and one line for each option.
std::string usage_text(const std::string& head, const std::vector<Option>& options);

/// Sets what the words ask for and returns those that are not options. Throws Error for unknown options and
/// values.
std::vector<std::string> parse_options(int argc, char** argv, const std::string& head,
                                       const std::vector<Option>& options);

/// The number that `word` spells. Throws Error if it is not one from `least` to `most`.
template <class T>
T number(const std::string& word, T least, T most) {
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !(value >= least && value <= most))
    throw Error("expected a number from " + std::to_string(least) + " to " + std::to_string(most) +
                ", found '" + word + "'");
  return value;
}

/// What `parse` makes of each word of a list with commas.
template <class F>
auto each(const std::string& list, const F& parse) {
  std::vector<decltype(parse(list))> values;
  std::istringstream words(list + ',');
  for (std::string word; std::getline(words, word, ',');) values.push_back(parse(word));
  return values;
}

/// Throws Error if the file cannot be written.
void write_text(const std::string& path, const std::string& text);

/// Runs a program, prints what it throws, and returns the exit status: 1 for failed input or output, 2 for
/// bad input.
int run_program(int (*run)(int argc, char** argv), int argc, char** argv);

}  // namespace oktett::bench
