#include "io/text/number.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <random>
#include <string>

#include "io/text/file_content.h"

namespace oktett::test::text_number_test {
namespace {

/// A text with the zero bytes behind it that scanners rely on.
class Padded {
 public:
  explicit Padded(const std::string& text) : text_(text + std::string(MappedFile::kPadding, '\0')) {}
  const char* data() const { return text_.data(); }

 private:
  std::string text_;
};

/// The bits that scan_float reads from `text`. It must read all of it.
std::uint32_t scanned(const std::string& text) {
  const Padded padded(text);
  float value = 0;
  NumberProblem problem = NumberProblem::none;
  const char* end = scan_float(padded.data(), value, problem);
  EXPECT_EQ(end, padded.data() + text.size()) << text;
  return std::bit_cast<std::uint32_t>(value);
}

std::uint32_t expected(const std::string& text) {
  float value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return std::bit_cast<std::uint32_t>(value);
}

// The fast way is right to the last bit, or it is not taken.
TEST(ScanFloat, EqualsFromCharsForRandomDecimals) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 400000; ++i) {
    const int digits = 1 + static_cast<int>(random() % 19);
    std::string text = random() % 2 ? "-" : "";
    const int point = static_cast<int>(random() % static_cast<unsigned>(digits + 1));
    for (int k = 0; k < digits; ++k) {
      if (k == point) text += '.';
      text += static_cast<char>('0' + random() % 10);
    }
    if (random() % 4 == 0) text += "e" + std::to_string(static_cast<int>(random() % 40) - 20);
    ASSERT_EQ(scanned(text), expected(text)) << text;
  }
}

// Midpoints between floats, and their neighbours in the last digit, are where rounding twice goes wrong.
TEST(ScanFloat, EqualsFromCharsAtMidpoints) {
  std::mt19937 random(2);
  for (int i = 0; i < 100000; ++i) {
    const std::uint32_t significand = (1u << 23) | (random() >> 9);
    const int exponent = static_cast<int>(random() % 64) - 40;
    const double middle = std::ldexp(significand + 0.5, exponent);
    char buffer[128];
    const int digits = 9 + static_cast<int>(random() % 12);
    std::snprintf(buffer, sizeof buffer, "%.*g", digits, middle);
    ASSERT_EQ(scanned(buffer), expected(buffer)) << buffer;
    std::snprintf(buffer, sizeof buffer, "%.*f", digits, middle);
    ASSERT_EQ(scanned(buffer), expected(buffer)) << buffer;
  }
}

RC_GTEST_PROP(ScanFloat, ReadsBackEveryFiniteFloat, (std::uint32_t bits)) {
  const auto value = std::bit_cast<float>(bits);
  RC_PRE(std::isfinite(value));
  char buffer[128];
  for (const auto format :
       {std::chars_format::scientific, std::chars_format::fixed, std::chars_format::general}) {
    const std::to_chars_result result = std::to_chars(buffer, buffer + sizeof buffer, value, format);
    RC_ASSERT(scanned(std::string(buffer, result.ptr)) == bits);
  }
}

TEST(ScanFloat, StopsAtDelimitersOnly) {
  for (const char* text : {"1 2", "1\t", "1\n", "1\r\n", "1#", "1\\\n", "1"}) {
    const Padded padded(text);
    float value = 0;
    NumberProblem problem = NumberProblem::none;
    EXPECT_EQ(scan_float(padded.data(), value, problem), padded.data() + 1);
    EXPECT_EQ(value, 1);
  }
  for (const char* text :
       {"1x", "1\\2", "1,5", "1/2", "1.0.0", "", "-", "e5", ".", "1e", "+-1", "nanx", "1.#XYZ2"}) {
    const Padded padded(text);
    float value = 0;
    NumberProblem problem = NumberProblem::none;
    // A `#` begins a comment unless it is part of a known special number.
    if (std::string(text) == "1.#XYZ2") {
      EXPECT_EQ(scan_float(padded.data(), value, problem), padded.data() + 2);
      continue;
    }
    EXPECT_EQ(scan_float(padded.data(), value, problem), nullptr) << text;
    EXPECT_EQ(problem, NumberProblem::malformed) << text;
  }
}

TEST(ScanFloat, TellsTooGreatFromTooSmall) {
  for (const std::string text : {"1e39", "1e400", "123456789e99999999999999999999", "3.4028236e38",
                                 "0.00001e99", "1000000000000000000000000000000000000000"}) {
    const Padded padded(text);
    float value = 0;
    NumberProblem problem = NumberProblem::none;
    EXPECT_EQ(scan_float(padded.data(), value, problem), nullptr) << text;
    EXPECT_EQ(problem, NumberProblem::overflow) << text;
  }
  const std::string tiny = "0." + std::string(500, '0') + "1";
  for (const std::string& text :
       {std::string("1e-99"), std::string("1e-400"), std::string("100000e-99999999999999999999"),
        std::string("0e99999999999"), std::string("0.0e-5"), tiny})
    EXPECT_EQ(scanned(text), 0u) << text;
}

TEST(ScanWhole, ReadsUpTo64BitsAndStaysThere) {
  for (const auto& [text, value] : {std::pair<const char*, std::uint64_t>{"7", 7},
                                    {"1234567", 1234567},
                                    {"12345678", 12345678},
                                    {"0000000000000000000000012", 12},
                                    {"18446744073709551615", 18446744073709551615u},
                                    {"18446744073709551616", 18446744073709551615u},
                                    {"99999999999999999999999", 18446744073709551615u}}) {
    const Padded padded(std::string(text) + "/");
    std::uint64_t read = 0;
    EXPECT_EQ(*scan_whole(padded.data(), read), '/');
    EXPECT_EQ(read, value);
  }
  std::uint64_t read = 0;
  const Padded word("x");
  EXPECT_EQ(scan_whole(word.data(), read), word.data());
}

}  // namespace
}  // namespace oktett::test::text_number_test
