// What the system or the user refuses - memory, threads, large files, closed streams, time, folders - ends in
// one line and a documented status.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/app/run_command.h"
#include "tests/support/sanitizers.h"
#include "tests/support/temp_dir.h"

namespace oktett::refusal_command_test {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::contains;
using test::file_content;
using test::file_count;
using test::kBall;
using test::run_command;
using test::TempDir;

// Sanitizers need terabytes of address space. An emulator counts its own memory, and qemu-user sets no limit
// for the program that it runs.
constexpr bool kCanLimitMemory = !test::kSanitized && !test::kEmulated;

std::ptrdiff_t lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

/// Runs `oktett WORDS` in a shell after `before`; the words may redirect.
CommandResult run_in_shell(const TempDir& dir, const std::string& before, const std::string& words) {
  return run_command(dir, {"-c", before + " exec '" + OKTETT_COMMAND + "' " + words}, "/bin/sh");
}

/// A wavy square of 2 n^2 triangles.
std::string square(int n) {
  std::string text;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      text +=
          "v " + std::to_string(i) + " " + std::to_string(j) + " " + std::to_string(std::sin(0.3 * i)) + "\n";
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const std::string a = std::to_string(j * (n + 1) + i + 1), b = std::to_string(j * (n + 1) + i + 2),
                        c = std::to_string((j + 1) * (n + 1) + i + 2);
      text += "f " + a + " " + b + " " + c + "\n";
    }
  return text;
}

void expect_refused_in_one_line(const CommandResult& result, const std::string& what) {
  if (result.status == 0) return;
  EXPECT_EQ(result.status, 1) << what << "\n" << result.err;
  EXPECT_EQ(lines(result.err), 1) << what << "\n" << result.err;
  EXPECT_TRUE(contains(result.err, "oktett: out of memory") ||
              contains(result.err, "oktett: the system refuses") ||
              contains(result.err, "Cannot allocate memory"))
      << what << "\n"
      << result.err;
}

// From too little to start with up to enough. What is refused may be the memory for data, a thread's stack or
// a library.
TEST(Refusal, MemoryIsOneLine) {
  if (!kCanLimitMemory) GTEST_SKIP() << "sanitizers and emulators need memory of their own";
  const TempDir dir;
  dir.write("mesh.obj", square(120));
  int refused = 0, done = 0;
  for (const char* rest : {"-t 1 -o a.exr", "-t 8 -o a.exr", "-t 2 -o a.jpg"}) {
    for (int kilobytes = 20000; kilobytes <= 900000; kilobytes += kilobytes / 4) {
      const std::string limit = "ulimit -c 0; ulimit -v " + std::to_string(kilobytes) + ";";
      // With less the loader of programs gives up, or oneTBB 2022.1 reads through a null pointer while it is
      // loaded.
      const int start = kilobytes < 100000 ? run_in_shell(dir, limit, "--version").status : 0;
      if (start == 127 || start < 0) continue;
      const CommandResult result =
          run_in_shell(dir, limit, std::string("render mesh.obj --size 32x32 --spp 1 --quiet ") + rest);
      expect_refused_in_one_line(result, limit + rest);
      ++(result.status == 0 ? done : refused);
      fs::remove(dir.file("a.exr"));
      fs::remove(dir.file("a.jpg"));
      EXPECT_EQ(file_count(dir), 1u) << limit << rest;
    }
  }
  EXPECT_GT(refused, 3);
  EXPECT_GT(done, 3);
}

TEST(Refusal, MostMemoryIsAnOption) {
  const TempDir dir;
  dir.write("mesh.obj", square(300));
  const std::vector<std::string> words{"render", "mesh.obj", "--size", "8x8",         "--spp",
                                       "1",      "-t",       "1",      "--max-memory"};
  const auto with = [&](const char* limit) {
    std::vector<std::string> all = words;
    all.emplace_back(limit);
    return run_command(dir, all);
  };
  if (kCanLimitMemory) {
    const CommandResult result = with("6M");
    EXPECT_EQ(result.status, 1);
    expect_refused_in_one_line(result, "6M");
    EXPECT_FALSE(fs::exists(dir.file("mesh.png")));
    EXPECT_EQ(with("2G").status, 0);
  }
  for (const char* bad : {"0", "-1", "12x", "1.5G", "M", "99999999999999999999", "99999999999G", ""}) {
    const CommandResult result = with(bad);
    EXPECT_EQ(result.status, 2) << bad;
    EXPECT_TRUE(contains(result.err, "--max-memory")) << result.err;
  }
}

TEST(Refusal, AFileThatMustNotGrowLeavesWhatWasThere) {
  const TempDir dir;
  dir.write("ball.yaml", kBall);
  dir.write("a.exr", "old");
  const CommandResult result = run_in_shell(dir, "ulimit -f 1;", "render ball.yaml --size 200x200 -o a.exr");
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.err, "a.exr: cannot write: File too large\n");
  EXPECT_EQ(file_content(dir.file("a.exr")), "old");
  EXPECT_EQ(file_count(dir), 2u);
}

TEST(Refusal, LostOutputIsAnError) {
  const TempDir dir;
  dir.write("ball.yaml", kBall);
  for (const char* words : {"info ball.yaml", "info ball.yaml --json", "render ball.yaml --stats",
                            "render ball.yaml --stats=json", "--version", "info --shapes",
                            "verify --surface torus --rays 1000"}) {
    for (const char* to : {" >/dev/full", " >&-"}) {
      const CommandResult result = run_in_shell(dir, "", std::string(words) + to);
      EXPECT_EQ(result.status, 1) << words << to;
      EXPECT_TRUE(contains(result.err, "oktett: cannot write to standard output: "))
          << words << to << result.err;
    }
  }
}

// Messages that nobody can read are no reason to lose a picture, and no message becomes a part of it.
TEST(Refusal, LostMessagesAreNone) {
  const TempDir dir;
  dir.write("ball.yaml", std::string(kBall) + "  - sphere: {radius: 0}\n");
  for (const char* to : {" 2>/dev/full", " 2>&-", " <&- 2>&-"}) {
    EXPECT_EQ(run_in_shell(dir, "", std::string("render ball.yaml --progress -o b.png") + to).status, 0)
        << to;
    const std::string picture = file_content(dir.file("b.png"));
    EXPECT_EQ(picture.substr(1, 3), "PNG") << to;
    EXPECT_TRUE(contains(picture, "IEND")) << to;
    EXPECT_FALSE(contains(picture, "warning")) << to;
  }
}

TEST(Refusal, OutputMayBeUnwanted) {
  const TempDir dir;
  dir.write("ball.yaml", kBall);
  const CommandResult result = run_command(dir, {"render", "ball.yaml", "--no-output"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "rays/s"));
  EXPECT_FALSE(contains(result.out, "wrote"));
  EXPECT_EQ(file_count(dir), 1u);
  for (const std::vector<std::string>& words : {std::vector<std::string>{"render", "ball.yaml", "-o", ""},
                                                {"render", "ball.yaml", "--outfile="},
                                                {"render", "ball.yaml", "--size", ""},
                                                {"render", "ball.yaml", "--no-output", "-o", "a.png"}}) {
    const CommandResult bad = run_command(dir, words);
    EXPECT_EQ(bad.status, 2) << words.back();
    EXPECT_EQ(bad.out, "");
  }
  EXPECT_EQ(file_count(dir), 1u);
}

TEST(Refusal, TimeKeepsWhatIsDone) {
  const TempDir dir;
  dir.write("ball.yaml", kBall);
  const CommandResult result = run_command(dir, {"render", "ball.yaml", "--size", "2048x2048", "--spp", "256",
                                                 "--timeout", "1.5", "-o", "long.png"});
  EXPECT_EQ(result.status, 124);
  EXPECT_TRUE(contains(result.err, "stopped by --timeout: ")) << result.err;
  EXPECT_TRUE(contains(result.out, "wrote long.png"));
  EXPECT_TRUE(fs::exists(dir.file("long.png")));
  EXPECT_EQ(run_command(dir, {"render", "ball.yaml", "--timeout", "1000"}).status, 0);
  // Nothing is rendered yet while a scene is loaded.
  std::string large = "oktett: 1\nobjects:\n";
  for (int i = 0; i < 50000; ++i) large += "  - sphere: {center: [1, 2, 3], radius: 1}\n";
  dir.write("large.yaml", large);
  for (const char* verb : {"render", "info"}) {
    const CommandResult early = run_command(dir, {verb, "large.yaml", "--timeout", "0.02"});
    EXPECT_EQ(early.status, 124);
    EXPECT_TRUE(contains(early.err, "--timeout: the time is up")) << early.err;
  }
  EXPECT_FALSE(fs::exists(dir.file("large.png")));
  for (const char* bad : {"0", "-3", "soon", "inf", "nan", "1e9", ""})
    EXPECT_EQ(run_command(dir, {"render", "ball.yaml", "--timeout", bad}).status, 2) << bad;
}

/// A folder for strangers with a secret beside it.
struct Strangers {
  TempDir dir;
  Strangers() {
    fs::create_directories(dir.path() / "jail/inner");
    dir.write("secret.yaml", kBall);
    dir.write("secret.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    dir.write("jail/inner/mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    fs::create_symlink("../secret.obj", dir.path() / "jail/link.obj");
    fs::create_symlink("inner", dir.path() / "jail/ring");
  }
  CommandResult run(const std::string& scene_body, const std::string& verb = "info") {
    dir.write("jail/scene.yaml", "oktett: 1\n" + scene_body);
    return run_command(dir, {verb, "jail/scene.yaml", "--root", "jail"});
  }
};

TEST(Refusal, FilesOutsideOfTheRoot) {
  Strangers strangers;
  for (const char* inside :
       {"inner/mesh.obj", "ring/mesh.obj", "inner/../inner/mesh.obj", "./inner/mesh.obj"}) {
    const CommandResult result = strangers.run(std::string("objects: [{mesh: {file: ") + inside + "}}]\n");
    EXPECT_EQ(result.status, 0) << inside << result.err;
  }
  const std::string absolute = strangers.dir.file("secret.obj");
  const std::string bodies[] = {"objects: [{mesh: {file: ../secret.obj}}]\n",
                                "objects: [{mesh: {file: link.obj}}]\n",
                                "objects: [{mesh: {file: inner/../../secret.obj}}]\n",
                                "objects: [{mesh: {file: ../absent.obj}}]\n",
                                "objects: [{mesh: {file: " + absolute + "}}]\n",
                                "include: [../secret.yaml]\n",
                                "objects: [{spheres: {file: /etc/passwd}}]\n",
                                "objects: [{metaballs: {file: /etc/passwd}}]\n",
                                "background: [1, 1, 1]\nlights: [{environment: {file: ../secret.obj}}]\n",
                                "objects: [{sphere: {}, material: {color_texture: ../secret.obj}}]\n"};
  for (const std::string& body : bodies) {
    const CommandResult result = strangers.run(body);
    EXPECT_EQ(result.status, 2) << body << result.err;
    if (!contains(body, "_texture") && !contains(body, "environment")) {
      EXPECT_TRUE(contains(result.err, "lies outside of the folder")) << body << result.err;
    }
    EXPECT_FALSE(contains(result.err, "no such file")) << body << result.err;
  }
  const TempDir& dir = strangers.dir;
  EXPECT_EQ(run_command(dir, {"info", "secret.yaml", "--root", "jail"}).status, 1);
  EXPECT_EQ(run_command(dir, {"info", "secret.obj", "--root", "jail"}).status, 1);
  EXPECT_EQ(run_command(dir, {"info", "secret.obj", "--root", "absent"}).status, 1);
  EXPECT_EQ(run_command(dir, {"info", "secret.obj", "--root", "secret.obj"}).status, 1);
  EXPECT_EQ(run_command(dir, {"info", "secret.obj", "--root", "."}).status, 0);
}

// Materials and images of meshes are optional: what is outside gives a warning.
TEST(Refusal, TexturesOutsideOfTheRoot) {
  Strangers strangers;
  const TempDir& dir = strangers.dir;
  dir.write("secret.mtl", "newmtl a\nKd 1 0 0\n");
  dir.write("secret.png", "x");
  dir.write("jail/film.png", "#EXTM3U\nfile:///etc/passwd\n");
  dir.write("jail/a.mtl", "newmtl a\nmap_Kd ../secret.png\nmap_Ks film.png\n");
  dir.write("jail/a.obj", "mtllib ../secret.mtl a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  const CommandResult result =
      run_command(dir, {"render", "jail/a.obj", "--root", "jail", "--no-output", "--size", "4x4"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "secret.mtl: cannot read: it lies outside")) << result.err;
  EXPECT_TRUE(
      contains(result.err, "jail/a.mtl:2:1: warning: texture jail/../secret.png not used: lies outside"))
      << result.err;
  EXPECT_TRUE(
      contains(result.err, "jail/a.mtl:3:1: warning: texture jail/film.png not used: begins like none"))
      << result.err;
}

}  // namespace
}  // namespace oktett::refusal_command_test
