// The option --cache: the same pictures and films, faster; problems with the folder are one line.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "io/image/image.h"
#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::cache_command_test {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::contains;
using test::file_content;
using test::run_command;
using test::TempDir;
using Words = std::vector<std::string>;

/// 2 n^2 triangles, more than a megabyte for n = 200.
std::string hills(int n) {
  std::string text;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      text += "v " + std::to_string(2.0 * i / n - 1) + " " +
              std::to_string(0.1 * std::sin(0.3 * i) * std::cos(0.2 * j)) + " " +
              std::to_string(2.0 * j / n - 1) + "\n";
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i + 1;
      for (const int corner : {a, a + n + 1, a + n + 2})
        text += (corner == a ? "f " : " ") + std::to_string(corner);
      text += "\n";
      for (const int corner : {a, a + n + 2, a + 1})
        text += (corner == a ? "f " : " ") + std::to_string(corner);
      text += "\n";
    }
  return text;
}

class CacheCommand : public testing::Test {
 protected:
  CacheCommand() {
    dir_.write("a.yaml",
               "oktett: 1\nfilm: {width: 40, height: 30}\nintegrator: {samples: 2}\n"
               "camera: {from: [0, 1, 3], at: [0, 0, 0]}\n"
               "lights: [{point: {position: [1, 3, 2]}}]\n"
               "objects:\n  - mesh: {file: hills.obj}\n  - sphere: {center: [0, 0.3, 0], radius: 0.3}\n");
    dir_.write("hills.obj", hills(200));
  }
  CommandResult render(Words words) const {
    words.insert(words.begin(), {"render", "a.yaml"});
    return run_command(dir_, words);
  }
  void expect_quiet(const Words& words) const {
    const CommandResult result = render(words);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "");
  }
  std::string pixels(const std::string& name) const {
    const Picture picture = read_image(dir_.file(name));
    std::string bytes;
    for (const auto& plane : picture.planes)
      bytes.append(reinterpret_cast<const char*>(plane.values.data()), plane.values.size() * sizeof(float));
    return bytes;
  }
  std::size_t entries(const std::string& folder, const char* extension) const {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(dir_.file(folder)))
      count += entry.path().extension() == extension;
    return count;
  }

  TempDir dir_;
};

TEST_F(CacheCommand, PicturesAndFilmsAreTheSame) {
  expect_quiet({"-o", "a.exr"});
  expect_quiet({"-o", "b.exr", "--cache", "kept"});
  EXPECT_EQ(entries("kept", ".mesh"), 1u);
  EXPECT_EQ(entries("kept", ".tree"), 1u);
  expect_quiet({"-o", "c.exr", "--cache", "kept"});
  EXPECT_EQ(pixels("a.exr"), pixels("b.exr"));
  EXPECT_EQ(pixels("a.exr"), pixels("c.exr"));
  // A share does not tell whether the mesh came from the cache, nor does a resumed one.
  expect_quiet({"-o", "1.film", "--shard", "1/2"});
  expect_quiet({"-o", "2.film", "--shard", "2/2", "--cache", "kept"});
  EXPECT_EQ(run_command(dir_, {"render", "--resume", "2.film", "--cache", "kept"}).status, 0);
  EXPECT_EQ(run_command(dir_, {"merge", "1.film", "2.film", "-o", "m.exr"}).status, 0);
  EXPECT_EQ(pixels("a.exr"), pixels("m.exr"));
}

TEST_F(CacheCommand, FoldersThatCannotBeUsedCostOneLine) {
  expect_quiet({"-o", "a.exr"});
  dir_.write("file", "");
  // A file, a file system that cannot be written to, and one without room.
  for (const char* folder : {"file", "file/in/it", "/proc/oktett", "/sys/kernel"}) {
    const CommandResult result = render({"-o", "b.exr", "--cache", folder});
    EXPECT_EQ(result.status, 0) << folder << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << folder << result.err;
    EXPECT_TRUE(result.err.starts_with("warning: ") && contains(result.err, folder)) << result.err;
    EXPECT_EQ(pixels("a.exr"), pixels("b.exr"));
  }
  const CommandResult full = run_command(
      dir_,
      {"-c", std::string("ulimit -f 100; exec '") + OKTETT_COMMAND + "' render a.yaml -o c.exr --cache kept"},
      "/bin/sh");
  EXPECT_EQ(full.status, 0) << full.err;
  EXPECT_EQ(std::count(full.err.begin(), full.err.end(), '\n'), 1) << full.err;
  EXPECT_TRUE(contains(full.err, "cannot write: File too large; the cache is not written")) << full.err;
  EXPECT_EQ(entries("kept", ".mesh") + entries("kept", ".tree"), 0u);
}

TEST_F(CacheCommand, DamagedEntriesCostOneLine) {
  expect_quiet({"-o", "a.exr", "--cache", "kept"});
  for (const auto& entry : fs::directory_iterator(dir_.file("kept")))
    if (entry.path().extension() == ".tree") fs::resize_file(entry.path(), fs::file_size(entry.path()) - 1);
  const CommandResult result = render({"-o", "b.exr", "--cache", "kept"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_TRUE(contains(result.err, ".tree: ") && contains(result.err, "; not used")) << result.err;
  EXPECT_EQ(pixels("a.exr"), pixels("b.exr"));
  expect_quiet({"-o", "c.exr", "--cache", "kept"});
}

// What is in the cache cannot be had through it by those who may not read the file.
TEST_F(CacheCommand, FilesOutsideOfTheRootAreRefused) {
  fs::create_directory(dir_.file("inside"));
  fs::rename(dir_.file("a.yaml"), dir_.file("inside/a.yaml"));
  fs::create_symlink("../hills.obj", dir_.file("inside/hills.obj"));
  const Words words{"render", "inside/a.yaml", "-o", "a.exr", "--cache", "kept"};
  EXPECT_EQ(run_command(dir_, words).status, 0);
  Words confined = words;
  confined.insert(confined.end(), {"--root", "inside"});
  const CommandResult result = run_command(dir_, confined);
  EXPECT_NE(result.status, 0);
  EXPECT_TRUE(contains(result.err, "outside")) << result.err;
}

TEST_F(CacheCommand, TheSizeIsAnOption) {
  expect_quiet({"-o", "a.exr", "--cache", "kept", "--cache-size", "1M"});
  EXPECT_EQ(entries("kept", ".tree"), 0u);
  for (const Words& bad : {Words{"--cache", "kept", "--cache-size", "much"}, Words{"--cache-size", "1M"}})
    EXPECT_EQ(render(bad).status, 2);
}

}  // namespace
}  // namespace oktett::cache_command_test
