/// \file Runs a fuzz target without a fuzzer, with any compiler: on the files and folders given, then on as
/// many random changes of them as `--changes N` says. The tests replay the seeds and all findings in this
/// way. The input that runs lies in the file `NAME.input` of the working directory, which stays there if the
/// process ends with it.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/input.h"

namespace oktett::test {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_in(const std::vector<fs::path>& paths) {
  std::vector<fs::path> files;
  for (const fs::path& path : paths) {
    if (!fs::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    for (const auto& entry : fs::directory_iterator(path))
      if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Inputs, and their random changes: the same ones on every machine.
class Inputs {
 public:
  explicit Inputs(std::vector<std::string> inputs) : inputs_(std::move(inputs)) {}

  std::string changed(std::size_t number) {
    std::string text = inputs_[number % inputs_.size()];
    for (std::size_t left = 1 + below(4); left > 0; --left) change(text);
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

  void change(std::string& text) {
    const std::size_t at = below(text.size());
    const std::size_t size = std::min(below(std::size_t{1} << below(8)) + 1, text.size() - at);
    const std::string& other = inputs_[below(inputs_.size())];
    switch (below(6)) {
      case 0:  // a bit
        if (!text.empty()) text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
        break;
      case 1:  // a byte
        if (!text.empty()) text[at] = static_cast<char>(random_());
        break;
      case 2:  // a byte that is often special
        if (!text.empty()) text[at] = "\x00\xff\x7f\x80 -9.e\n"[below(10)];
        break;
      case 3:
        text.erase(at, size);
        break;
      case 4:
        text.insert(at, text.substr(at, size));
        break;
      default:  // a piece of any input
        text.insert(at, other, below(other.size()), size + 4);
    }
  }

  std::vector<std::string> inputs_;
  std::mt19937_64 random_;
};

}  // namespace
}  // namespace oktett::test

int main(int count, char** arguments) {
  using namespace oktett::test;
  std::vector<fs::path> paths;
  std::size_t changes = 0;
  for (int i = 1; i < count; ++i) {
    if (arguments[i] == std::string("--changes") && i + 1 < count)
      changes = std::strtoull(arguments[++i], nullptr, 10);
    else
      paths.emplace_back(arguments[i]);
  }
  const std::string path = fs::path(arguments[0]).filename().string() + ".input";
  RewrittenFile running(path);
  const auto run = [&](const std::string& text) {
    running.write(text);
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  };
  std::vector<std::string> texts;
  for (const fs::path& file : files_in(paths)) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) {
      std::fprintf(stderr, "cannot read %s\n", file.c_str());
      return 1;
    }
    texts.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    std::fprintf(stderr, "%s\n", file.filename().c_str());
    run(texts.back());
  }
  if (texts.empty()) return 1;
  Inputs inputs(texts);
  for (std::size_t i = 0; i < changes; ++i) run(inputs.changed(i));
  fs::remove(path);
  std::printf("replayed %zu inputs and %zu changes of them\n", texts.size(), changes);
  return 0;
}
