#include "render/pattern_kinds.h"

#include <algorithm>

namespace oktett {

bool FunctionPattern::operator==(const FunctionPattern& other) const {
  const auto same = [](const TapeStep& s, const TapeStep& t) {
    return s.op == t.op && s.out == t.out && s.a == t.a && s.b == t.b && s.n == t.n && s.c == t.c;
  };
  return function.result == other.function.result && texture == other.texture &&
         std::ranges::equal(function.steps, other.function.steps, same);
}

}  // namespace oktett
