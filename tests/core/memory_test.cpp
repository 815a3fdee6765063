#include "core/memory.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "tests/support/temp_dir.h"

namespace oktett::memory_test {
namespace {

constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();

class Memory : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) {
    const std::filesystem::path path = dir_.path() / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  std::uint64_t available() const {
    const std::string dir = dir_.path().string();
    return available_memory(dir + "/meminfo", dir + "/self", dir + "/groups");
  }
  test::TempDir dir_;
};

TEST_F(Memory, NothingIsKnownWithoutFiles) { EXPECT_EQ(available(), kUnknown); }

TEST_F(Memory, TheSystemTells) {
  write("meminfo", "MemTotal:  24000000 kB\nMemFree: 1 kB\nMemAvailable:   20000000 kB\n");
  EXPECT_EQ(available(), 20'000'000ull * 1024);
  write("meminfo", "MemAvailable: many kB\n");
  EXPECT_EQ(available(), kUnknown);
}

TEST_F(Memory, TheStrictestGroupCounts) {
  write("meminfo", "MemAvailable: 1000 kB\n");
  write("self", "0::/a/b\n");
  write("groups/memory.max", "max\n");
  write("groups/memory.current", "500000\n");
  EXPECT_EQ(available(), 1'024'000u);
  write("groups/a/memory.max", "900000\n");
  write("groups/a/memory.current", "500000\n");
  EXPECT_EQ(available(), 400'000u);
  write("groups/a/memory.stat", "anon 3\ninactive_file 200000\n");
  EXPECT_EQ(available(), 600'000u);
  write("groups/a/b/memory.max", "300000\n");
  write("groups/a/b/memory.current", "400000\n");
  EXPECT_EQ(available(), 0u);
}

TEST_F(Memory, OldGroupsCountToo) {
  write("self", "5:cpu:/x\n4:memory:/c\n0::/\n");
  write("groups/memory/c/memory.limit_in_bytes", "7000\n");
  write("groups/memory/c/memory.usage_in_bytes", "3000\n");
  write("groups/memory/c/memory.stat", "total_inactive_file 1000\n");
  EXPECT_EQ(available(), 5000u);
}

TEST(MemoryText, HasItsUnit) {
  EXPECT_EQ(memory_text(14'460'000'000), "14.5 GB");
  EXPECT_EQ(memory_text(999'999'999), "1000 MB");
  EXPECT_EQ(memory_text(0), "0 MB");
}

}  // namespace
}  // namespace oktett::memory_test
