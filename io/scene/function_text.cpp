#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/scene/shape_text.h"
#include "kernels/functions/expression.h"
#include "kernels/functions/tape_data.h"

namespace oktett {
namespace {

/// How the steps are written: of their operands a and b, their constant c and their whole number n.
constexpr const char* kPatterns[] = {
#define OP(name, text, step) text,
    OKTETT_TAPE_OPS(OP)
#undef OP
};

std::string written_out(const FunctionTape& tape, std::span<const std::string_view> variables) {
  std::vector<std::string> r(static_cast<std::size_t>(tape.registers));
  std::ranges::copy(variables, r.begin());
  for (const TapeStep& s : tape.steps) {
    // Copies, since a result may overwrite what it is made of.
    const std::string a = r[s.a], b = r[s.b];
    const std::string third = has_third(s.op) ? r[static_cast<std::size_t>(s.n)] : "";
    r[s.out] =
        fmt::format(fmt::runtime(kPatterns[static_cast<int>(s.op)]), fmt::arg("a", a), fmt::arg("b", b),
                    fmt::arg("c", number_text(s.c)), fmt::arg("n", s.n), fmt::arg("third", third));
    if (s.op == TapeOp::sin_cos) r[s.b] = "cos(" + a + ")";
    if (r[s.out].size() > kMaxExpressionLength)
      throw Error(fmt::format("the function has more than {} characters when it is written out",
                              kMaxExpressionLength));
  }
  return r[tape.result];
}

}  // namespace

std::string function_text(const FunctionTape& tape, std::span<const std::string_view> variables) {
  // Read once: operands that may be exchanged stand in the order of the text then.
  return written_out(compile_function(written_out(tape, variables), variables), variables);
}

}  // namespace oktett
