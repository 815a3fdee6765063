// Root finders on raw coefficients against counts in exact arithmetic.

#include <algorithm>
#include <cmath>

#include "kernels/roots/roots.h"
#include "tests/fuzz/input.h"
#include "tests/support/exact_roots.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  using namespace oktett::roots;
  test::InputBytes bytes(data, size);
  const auto shape = bytes.take<std::uint8_t>();
  const auto number = [&]() -> double {
    return shape & 0x80 ? bytes.take<double>() : static_cast<double>(bytes.number());
  };
  Polynomial p;
  p.degree = shape % 9;
  bool finite = true, zero = true;
  double most = 0, least = HUGE_VAL;
  for (int i = 0; i <= p.degree; ++i) {
    p.c[i] = number();
    finite = finite && std::isfinite(p.c[i]);
    if (p.c[i] == 0) continue;
    zero = false;
    most = std::max(most, std::abs(p.c[i])), least = std::min(least, std::abs(p.c[i]));
  }
  const double a = number(), b = number();
  for (const Method method : {Method::automatic, Method::closed, Method::bernstein, Method::sturm,
                              Method::laguerre, Method::bisection, Method::newton}) {
    const Roots answer = solve(p, a, b, method);
    test::require(answer.count >= 0 && answer.count <= kMaxDegree, "no more roots than there can be");
    for (int i = 0; i < answer.count; ++i) {
      test::require(!std::isnan(answer.root[i].x), "roots are numbers");
      test::require(i == 0 || answer.root[i].x >= answer.root[i - 1].x, "roots in ascending order");
    }
    if (!finite || std::isnan(a) || std::isnan(b)) test::require(answer.count == 0, "nothing of no numbers");
    // The oracle's integers have as many bits as the exponents are apart.
    if (answer.certified && !zero && finite && std::isfinite(a) && std::isfinite(b) && a <= b &&
        most < 1e30 && least > 1e-30) {
      const test::Judgement j = test::judge(p, a, b, answer);
      if (j.missed + j.invented > 0) std::fprintf(stderr, "%s: %s\n", to_string(method), j.what.c_str());
      test::require(j.missed + j.invented == 0, "a certified answer is true");
    }
  }
  return 0;
}
