#include "bench/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

namespace oktett::bench {

std::string usage_text(const std::string& head, const std::vector<Option>& options) {
  std::string text = head;
  for (const Option& o : options)
    text += fmt::format("\n  {:<24} {}", fmt::format("{} {}", o.name, o.value), o.help);
  return text;
}

std::vector<std::string> parse_options(int argc, char** argv, const std::string& head,
                                       const std::vector<Option>& options) {
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (!word.starts_with("--")) {
      words.push_back(word);
      continue;
    }
    const auto option = std::ranges::find(options, word, &Option::name);
    if (option == options.end()) throw Error("unknown option " + word + "\n" + usage_text(head, options));
    const bool alone = *option->value == 0;
    if (!alone && (++i >= argc || *argv[i] == 0)) throw Error(word + " needs a value");
    try {
      option->set(alone ? "" : argv[i]);
    } catch (const Error& error) {
      throw Error(word + ": " + error.what());
    }
  }
  return words;
}

void write_text(const std::string& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  if (!(out << text << std::flush)) throw Error({path, 0, 0}, "cannot be written", ErrorKind::io);
}

int run_program(int (*run)(int argc, char** argv), int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return error.kind() == ErrorKind::io ? 1 : 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}

}  // namespace oktett::bench
