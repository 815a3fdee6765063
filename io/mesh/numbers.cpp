#include "io/mesh/numbers.h"

#include <fmt/format.h>

namespace oktett {

void stop_at_number(const char* p, NumberProblem problem) {
  if (is_line_end(*p) || *p == '#') stop_at(p, "expected a number, found the end of the line");
  if (problem == NumberProblem::overflow)
    stop_at(p, "expected a finite number, but " + quote_word(p) + " is out of range");
  stop_at(p, "expected a number, found " + quote_word(p));
}

void stop_at_coordinate(const char* p, float x) {
  if (!std::isfinite(x)) stop_at(p, "expected a finite number, found " + quote_word(p));
  stop_at(p, "coordinate out of range: " + quote_word(p) + " (magnitude at most 1e30)");
}

std::string bad_coordinate(float x) {
  if (std::isfinite(x)) return fmt::format("coordinate out of range: {} (magnitude at most 1e30)", x);
  return std::string("expected a finite number, found ") + (std::isnan(x) ? "nan" : x > 0 ? "inf" : "-inf");
}

}  // namespace oktett
