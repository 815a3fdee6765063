// Disks that are full or may only be read, and folders that vanish: one line, and what was there stays.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::disk_command_test {
namespace {

namespace fs = std::filesystem;
using test::CommandProcess;
using test::CommandResult;
using test::contains;
using test::file_content;
using test::run_command;
using test::TempDir;

constexpr const char* kScene =
    "oktett: 1\n"
    "film: {width: 80, height: 60}\n"
    "integrator: {kind: path, samples: 2}\n"
    "camera: {from: [0, 2, 6], at: [0, 0, 0]}\n"
    "materials: {mirror: {reflection: 1, diffuse: 0}}\n"
    "lights: [{point: {position: [3, 5, 4]}}]\n"
    "objects:\n"
    "  - {sphere: {radius: 1}, material: mirror}\n"
    "  - plane: {normal: [0, 1, 0], offset: -1}\n";

/// What the command writes to a small disk.
struct Writer {
  const char* words;
  const char* file;       ///< on the disk
  const char* elsewhere;  ///< a file that is written in spite of that; empty: none
};
constexpr Writer kWriters[] = {
    {"render a.yaml -o disk/a.exr", "a.exr", ""},
    {"render a.yaml -o disk/a.png --size 300x300", "a.png", ""},
    {"render a.yaml --shard 1/2 -o disk/a.film", "a.film", ""},
    {"render a.yaml -o b.exr --checkpoint disk/a.film --every 0.01", "a.film", "b.exr"},
    {"render --resume disk/a.film --add-spp 2 -o b.exr", "a.film", "b.exr"},
    {"render a.yaml -o b.exr --photon-map disk/a.photons", "", "b.exr"},
    {"merge a.film -o disk/a.exr", "a.exr", ""},
    {"convert a.obj disk/a.stl", "a.stl", ""},
    {"convert a.obj disk/a.glb", "a.glb", ""}};

class DiskCommand : public testing::Test {
 protected:
  DiskCommand() {
    dir_.write("a.yaml", kScene);
    fs::create_directory(dir_.file("disk"));
    for (const char* file : {"a.exr", "a.png", "a.film"})
      EXPECT_EQ(run_command(dir_, {"render", "a.yaml", "-o", file}).status, 0);
    dir_.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for (const char* file : {"a.stl", "a.glb"})
      EXPECT_EQ(run_command(dir_, {"convert", "a.obj", file}).status, 0);
  }

  void SetUp() override {
    const CommandResult result =
        run_command(dir_, {"-c", "exec unshare -rm mount -t tmpfs none disk"}, "/bin/sh");
    if (result.status != 0) GTEST_SKIP() << "no disk can be mounted here: " << result.err;
  }

  /// Runs the command with a disk of its own at "disk", which holds the old file. `prepare` is a shell
  /// command that comes before.
  CommandResult run(const Writer& writer, const std::string& prepare) {
    for (const char* file : {"b.exr", "files", "seen"}) fs::remove(dir_.file(file));
    const std::string old = writer.file;
    dir_.write("script",
               "mount -t tmpfs -o size=4m none disk\n" + (old.empty() ? "" : "cp " + old + " disk/\n") +
                   prepare + "\n'" + OKTETT_COMMAND + "' " + writer.words + " --quiet\nstatus=$?\n" +
                   (old.empty() ? "" : "cp disk/" + old + " seen\n") + "ls -A disk >files; exit $status\n");
    return run_command(dir_, {"-rm", "sh", "script"}, "/usr/bin/unshare");
  }

  TempDir dir_;
};

/// The same for all writers. `fill` is the name of a file that takes the room.
void expect_one_line(const Writer& writer, const CommandResult& result, const TempDir& dir, bool full,
                     const char* message) {
  const std::string& err = result.err;
  EXPECT_EQ(result.status, 1) << writer.words << "\n" << err;
  EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << writer.words << "\n" << err;
  EXPECT_TRUE(contains(err, message)) << writer.words << "\n" << err;
  const std::string files = file_content(dir.file("files"));
  std::string expected = *writer.file == 0 ? "" : writer.file + std::string("\n");
  if (full) expected += "fill\n";
  EXPECT_EQ(files, expected) << writer.words;
  if (*writer.file == 0) return;
  EXPECT_EQ(file_content(dir.file("seen")), file_content(dir.file(writer.file))) << writer.words;
}

TEST_F(DiskCommand, FullDisksKeepWhatWasThere) {
  for (const Writer& writer : kWriters) {
    const CommandResult result = run(writer, "head -c 5000000 /dev/zero >disk/fill 2>/dev/null");
    expect_one_line(writer, result, dir_, true, "No space left on device");
    EXPECT_TRUE(*writer.elsewhere == 0 || fs::exists(dir_.file(writer.elsewhere))) << writer.words;
  }
}

TEST_F(DiskCommand, DisksThatMayOnlyBeReadKeepWhatIsThere) {
  for (const Writer& writer : kWriters) {
    const CommandResult result = run(writer, "mount -o remount,ro disk");
    expect_one_line(writer, result, dir_, false, "Read-only file system");
  }
}

/// The picture cannot be written any more, but its film can.
TEST_F(DiskCommand, PicturesWhoseFolderVanishesAreInTheFilm) {
  fs::create_directory(dir_.file("sub"));
  CommandProcess process(dir_, {"render", "a.yaml", "-o", "sub/a.exr", "--spp", "300", "-t", "1",
                                "--checkpoint", "c.film", "--every", "0.01"});
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!fs::exists(dir_.file("c.film")) && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  fs::remove_all(dir_.file("sub"));
  EXPECT_EQ(process.wait(), 1);
  EXPECT_EQ(process.err(), "sub/a.exr: cannot write: no directory 'sub'\n");
  EXPECT_EQ(run_command(dir_, {"merge", "c.film", "-o", "b.png"}).status, 0);
}

}  // namespace
}  // namespace oktett::disk_command_test
