// Damaged copies of the example scenes: each either loads or is refused with an Error, soon.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "io/scene/check.h"
#include "tests/io/scene_test_support.h"
#include "tests/support/sanitizers.h"

namespace oktett::scene_fuzz_test {
namespace {

/// Steele, Lea and Flood's SplitMix64: the same mutants on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  std::size_t below(std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(next() % n); }

 private:
  std::uint64_t state_;
};

const char* const kTokens[] = {
    "{",      "}",           "[",       "]",           ":",          ", ",        "- ",     "\n",   "\"",
    "'",      "#",           "&a ",     "*a",          "!!int ",     "? ",        "|\n",    ">\n",  "---\n",
    "...\n",  "${",          "$${x}",   "${row}",      ".inf",       ".nan",      "-1",     "0",    "1e300",
    "1e-300", "99999999999", "pi/0",    "((((",        "sphere:",    "instance:", "group:", "  ",   "\t",
    "\r\n",   "\xc3\xa9",    "\xff",    "%YAML 1.2\n", "true",       "null",      "~",      "<<: ", "\\u0000",
    "@",      "`",           "oktett:", "include:",    "transform:",
};

std::string mutate(std::string text, const std::string& other, Random& random) {
  const std::size_t changes = 1 + random.below(4);
  for (std::size_t i = 0; i < changes && !text.empty(); ++i) {
    const std::size_t at = random.below(text.size()), length = 1 + random.below(20);
    switch (random.below(7)) {
      case 0:
        text[at] = static_cast<char>(random.below(256));
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, text.substr(random.below(text.size()), length));
        break;
      case 3:
        text.insert(at, kTokens[random.below(std::size(kTokens))]);
        break;
      case 4:
        text.replace(at, 1, kTokens[random.below(std::size(kTokens))]);
        break;
      case 5:
        text.insert(at, other.substr(random.below(other.size()), 10 * length));
        break;
      default:
        text.resize(at);
        break;
    }
  }
  return text;
}

TEST(SceneFuzz, MutantsLoadOrAreRefused) {
  test::TempDir dir;
  const std::filesystem::path scenes = std::filesystem::path(OKTETT_SOURCE_DIR) / "scenes";
  std::filesystem::copy(scenes, dir.path(), std::filesystem::copy_options::recursive);
  std::vector<std::string> texts;
  for (const auto& entry : std::filesystem::directory_iterator(scenes)) {
    if (entry.path().extension() == ".yaml") texts.push_back(test::file_content(entry.path()));
  }
  std::sort(texts.begin(), texts.end());
  ASSERT_GE(texts.size(), 4u);
  Random random(2024);
  const unsigned mutants = test::cases(1000);
  unsigned loaded = 0, refused = 0;
  for (unsigned i = 0; i < mutants; ++i) {
    const std::string mutant =
        mutate(texts[random.below(texts.size())], texts[random.below(texts.size())], random);
    const std::string path = dir.write("mutant.yaml", mutant);
    std::string first;
    try {
      // A small mesh in place of the bunny keeps this quick.
      load_scene_file(path, {{"bunny", "assets/tetrahedron.obj"}});
      ++loaded;
    } catch (const Error& e) {
      EXPECT_FALSE(std::string(e.what()).empty());
      EXPECT_FALSE(e.where().file.empty()) << e.what();
      ++refused;
      first = e.what();
    }
    // Checking finds the same error among others, and none where there is none.
    bool has_errors = false, has_first = false;
    for (const SceneFinding& finding : check_file(path, {{"bunny", "assets/tetrahedron.obj"}}).list) {
      has_errors |= finding.kind != SceneFinding::Kind::warning;
      has_first |= finding.text == first;
    }
    EXPECT_EQ(has_errors, !first.empty()) << first << "\n" << mutant;
    EXPECT_TRUE(first.empty() || has_first) << first << "\n" << mutant;
  }
  EXPECT_GT(loaded, mutants / 50);
  EXPECT_GT(refused, mutants / 50);
}

}  // namespace
}  // namespace oktett::scene_fuzz_test
