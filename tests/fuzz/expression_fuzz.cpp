// Texts of functions: the value of a parsed expression against that of the compiled tape, and polynomials.

#include <cmath>
#include <span>

#include "core/error.h"
#include "kernels/exact/polynomial_expression.h"
#include "kernels/functions/expression.h"
#include "kernels/functions/tape_data.h"
#include "tests/fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  static constexpr std::string_view kNames[] = {"x", "y", "z"};
  const auto inside = [&](const Error& e) {
    test::require(*e.what() != 0 && e.where().column <= size + 1, "the column lies in the text");
  };
  try {
    const Expression e = parse_expression(text, kNames);
    test::require(!e.nodes.empty() && e.places.size() == e.nodes.size(), "a place for each node");
    const double values[] = {0.5, -1.25, 3};
    (void)evaluate(e, values);
  } catch (const Error& e) {
    inside(e);
  }
  try {
    const FunctionTape tape = compile_function(text);
    test::require(tape.result < 3 || !tape.steps.empty(), "a value is a variable or computed");
  } catch (const Error& e) {
    inside(e);
  }
  try {
    for (const Monomial& m : expand_polynomial(text))
      test::require(std::isfinite(m.c) && m.c != 0, "terms are finite and not 0");
  } catch (const Error& e) {
    inside(e);
  }
  return 0;
}
