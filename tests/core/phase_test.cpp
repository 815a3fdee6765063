#include "core/phase.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/parallel_for.h>

#include <string>
#include <vector>

namespace oktett::phase_test {
namespace {

class Phases : public testing::Test {
 protected:
  Phases() {
    watch_phases([this](const PhaseState& state) { seen.push_back(state); });
  }
  ~Phases() override { watch_phases({}); }

  std::vector<PhaseState> seen;
};

TEST_F(Phases, TheBeginningOfEachKindIsSeen) {
  const Phase reading("reading", "a.obj", 100);
  const Phase building("building", "", 0);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_STREQ(seen[0].kind, "reading");
  EXPECT_EQ(seen[0].what, "a.obj");
  EXPECT_EQ(seen[0].done, 0u);
  EXPECT_EQ(seen[0].total, 100u);
  EXPECT_STREQ(seen[1].kind, "building");
}

/// However often threads add, a watcher is called a few times, with sums that grow and end at the total.
TEST_F(Phases, ManyAdditionsAreSeenSeldom) {
  Phase phase("reading", "a.obj", 1000);
  oneapi::tbb::parallel_for(0, 1'000'000, [&](int) { phase.add(1); });
  const auto seconds = seen.back().seconds;
  EXPECT_LE(static_cast<double>(seen.size()), 2 + seconds * 10);
  for (std::size_t i = 1; i < seen.size(); ++i) EXPECT_LE(seen[i].done, 1000u);
}

TEST_F(Phases, NobodyIsCalledAfterTheEndOfWatching) {
  watch_phases({});
  Phase phase("reading", "a.obj", 10);
  phase.add(5);
  EXPECT_TRUE(seen.empty());
}

}  // namespace
}  // namespace oktett::phase_test
