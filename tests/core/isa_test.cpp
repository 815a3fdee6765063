#include "core/isa.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "core/error.h"

namespace oktett::isa_test {
namespace {

TEST(Isa, NamesAreReadBack) {
  for (Isa isa : {Isa::scalar, Isa::sse42, Isa::avx2, Isa::avx512, Isa::neon})
    EXPECT_EQ(parse_isa(to_string(isa)), isa);
  EXPECT_FALSE(parse_isa("avx3"));
  EXPECT_FALSE(parse_isa(""));
}

TEST(Isa, ScalarIsAlwaysThereAndTheListIsOrdered) {
  const std::vector<Isa> isas = available_isas();
  ASSERT_FALSE(isas.empty());
  EXPECT_EQ(isas.front(), Isa::scalar);
  EXPECT_TRUE(std::is_sorted(isas.begin(), isas.end()));
}

TEST(Isa, EnvironmentChooses) {
  const char* old = std::getenv("OKTETT_ISA");
  const std::string saved = old ? old : "";
  setenv("OKTETT_ISA", "scalar", 1);
  EXPECT_EQ(choose_isa("auto"), Isa::scalar);
  EXPECT_EQ(choose_isa(""), Isa::scalar);
  setenv("OKTETT_ISA", "mmx", 1);
  EXPECT_THROW(choose_isa("auto"), Error);
  setenv("OKTETT_ISA", "auto", 1);
  EXPECT_EQ(choose_isa("auto"), available_isas().back());
  // The default is what the first call found.
  setenv("OKTETT_ISA", "scalar", 1);
  const Isa first = default_isa();
  for (const char* name : {"mmx", "auto"}) {
    setenv("OKTETT_ISA", name, 1);
    EXPECT_EQ(default_isa(), first);
  }
  if (old)
    setenv("OKTETT_ISA", saved.c_str(), 1);
  else
    unsetenv("OKTETT_ISA");
}

TEST(Isa, UnknownNamesAreErrors) {
  EXPECT_EQ(choose_isa("scalar"), Isa::scalar);
  EXPECT_THROW(choose_isa("altivec"), Error);
  // Known, but no machine has all of them.
  for (const char* name : {"neon", "sse4.2"}) {
    const std::vector<Isa> isas = available_isas();
    if (std::find(isas.begin(), isas.end(), *parse_isa(name)) == isas.end()) {
      EXPECT_THROW(choose_isa(name), Error);
    } else {
      EXPECT_EQ(choose_isa(name), *parse_isa(name));
    }
  }
}

}  // namespace
}  // namespace oktett::isa_test
