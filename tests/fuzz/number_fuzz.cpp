// Floats of text files against the standard library's reading of the same text.

#include <charconv>
#include <cmath>

#include "io/text/number.h"
#include "tests/fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  // The scanner may read whole blocks past the end, as in a mapped file.
  static char text[4096 + 64];
  if (size > 4096) return 0;
  std::memcpy(text, data, size);
  std::memset(text + size, 0, 64);

  float value = 0;
  NumberProblem problem = NumberProblem::none;
  const char* end = scan_float(text, value, problem);
  test::require(end == nullptr || (end > text && end <= text + size), "the end lies in the text");
  test::require(end != nullptr || problem != NumberProblem::none, "a refusal has a reason");

  const bool plus = text[0] == '+';
  if (plus && text[1] == '-') return 0;
  float expected = 0;
  const auto [last, error] = std::from_chars(text + plus, text + size, expected);
  if (end == nullptr) {
    const bool whole = error == std::errc() && last == text + size && std::isfinite(expected);
    test::require(!whole || problem == NumberProblem::overflow || size == 0,
                  "what the library reads is read");
    return 0;
  }
  // The library knows neither the spellings of old Windows nor denormal numbers as 0.
  if (error == std::errc() && last == end && std::isfinite(expected) && expected != 0)
    test::require(value == expected || (value == 0 && std::abs(expected) < 0x1p-126f), "the nearest float");
  return 0;
}
