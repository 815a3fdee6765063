/// \file The random cases of verification keep to what the surfaces say of their parameters.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <type_traits>
#include <variant>

#include "verify/oracles/exact.h"

namespace oktett::described_cases_test {
namespace {

/// Finds parameters that the description does not allow, and shapes that it says are empty.
class RangeCheck : public ParameterVisitor<RangeCheck> {
 public:
  template <class T>
  bool visit(const Parameter& p, T& value) {
    if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>)
      expect(p, static_cast<double>(value));
    else if constexpr (std::is_same_v<T, Vec3d>)
      for (int k = 0; k < 3; ++k) expect(p, value[k]);
    else if constexpr (requires { value.begin(); } && !std::is_same_v<T, std::array<double, 10>>)
      if (p.need == Parameter::Need::required) expect(p, static_cast<double>(value.size()));
    return false;
  }
  void check(bool ok, const char*, const char* message, const double* = nullptr) {
    EXPECT_TRUE(ok) << message;
  }
  void nothing_if(bool is_empty, const char* reason) { EXPECT_FALSE(is_empty) << reason; }
  void normals() {}

  int numbers = 0;

 private:
  void expect(const Parameter& p, double value) {
    ++numbers;
    EXPECT_TRUE(p.range.contains(value)) << p.key << ": " << value;
  }
};

TEST(DescribedCases, KeepToTheRangesOfParameters) {
  RangeCheck check;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    CaseRandom random(seed);
    for (ExactOracle& oracle : draw_exact_oracles(random)) {
      SCOPED_TRACE(oracle.name);
      std::visit(
          [&](auto& shape) {
            if constexpr (requires { shape.describe(check); }) shape.describe(check);
          },
          oracle.shape.form);
    }
  }
  EXPECT_GT(check.numbers, 1000);
}

}  // namespace
}  // namespace oktett::described_cases_test
