/// \file Completion, manual pages and examples.

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::description_command_test {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::contains;
using test::run_command;
using test::TempDir;

using Words = std::vector<std::string>;

CommandResult run_shell(const TempDir& dir, const std::string& shell, const std::string& text) {
  return run_command(dir, {"-c", text}, shell);
}

bool has_program(const TempDir& dir, const std::string& name) {
  return run_shell(dir, "/bin/sh", "command -v " + name).status == 0;
}

std::set<std::string> lines_of(const std::string& text) {
  std::set<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    if (!line.empty()) lines.insert(line);
  return lines;
}

/// The long options of a verb, which begin lines of its --help.
std::set<std::string> long_options(const TempDir& dir, const std::string& verb) {
  std::set<std::string> options;
  for (const std::string& line : lines_of(run_command(dir, {verb, "--help"}).out)) {
    if (!line.starts_with("  -")) continue;
    const std::size_t start = line.find("--");
    if (start == 2 || (start == 5 && line[4] == ','))
      options.insert(line.substr(start, line.find_first_of(" {", start) - start));
  }
  return options;
}

class Completion : public testing::Test {
 protected:
  Completion() {
    for (const char* shell : {"bash", "zsh", "fish"}) {
      const CommandResult result = run_command(dir, {"completion", shell});
      EXPECT_EQ(result.status, 0) << result.err;
      dir.write(std::string("oktett.") + shell, result.out);
    }
    dir.write("a scene.yaml", "");
    dir.write("mesh.obj", "");
    fs::create_directory(dir.file("folder"));
  }

  /// What bash offers for the last of `words`, which it splits as it would a line.
  std::set<std::string> bash(const std::string& words, int count) {
    const CommandResult result = run_shell(dir, "/bin/bash",
                                           "source ./oktett.bash; compopt() { :; }; COMP_WORDS=(" + words +
                                               "); COMP_CWORD=" + std::to_string(count - 1) +
                                               "; _oktett; printf '%s\\n' \"${COMPREPLY[@]}\"");
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "") << words;
    return lines_of(result.out);
  }

  std::set<std::string> fish(const std::string& line) {
    const std::string text = "complete -e -c oktett; source ./oktett.fish; complete -C '" + line + "'";
    const CommandResult result =
        run_command(dir, {"HOME=.", "fish", "--no-config", "-c", text}, "/usr/bin/env");
    EXPECT_EQ(result.status, 0) << result.err;
    std::set<std::string> words;
    for (const std::string& offer : lines_of(result.out)) words.insert(offer.substr(0, offer.find('\t')));
    return words;
  }

  TempDir dir;
};

using Offers = std::set<std::string>;

TEST_F(Completion, Bash) {
  EXPECT_EQ(bash("oktett re", 2), Offers{"render"});
  EXPECT_EQ(bash("oktett --v", 2), Offers{"--version"});
  EXPECT_EQ(bash("oktett render --integ", 3), Offers{"--integrator"});
  EXPECT_EQ(bash("oktett render --integrator p", 4), (Offers{"path", "position", "primitive"}));
  EXPECT_EQ(bash("oktett render --integrator = p", 5), (Offers{"path", "position", "primitive"}));
  EXPECT_EQ(bash("oktett render --bvh =", 4), (Offers{"fast", "balanced", "best", "compact"}));
  EXPECT_EQ(bash("oktett render --spp ''", 4), Offers{});
  EXPECT_EQ(bash("oktett render a", 3), Offers{"a scene.yaml"});
  EXPECT_EQ(bash("oktett render -o m", 4), Offers{"mesh.obj"});
  EXPECT_EQ(bash("oktett render mesh.obj --cache ''", 5), Offers{"folder"});
  EXPECT_EQ(bash("oktett merge --tone a", 4), Offers{"aces"});
  EXPECT_EQ(bash("oktett nothing --x", 3), Offers{});
  EXPECT_EQ(bash("oktett info --", 3).count("--schema"), 1u);
}

TEST_F(Completion, BashOffersAllOptions) {
  for (const char* verb : {"render", "info", "check", "convert", "merge", "verify", "examples"}) {
    const Offers offers = bash(std::string("oktett ") + verb + " --", 3);
    for (const std::string& option : long_options(dir, verb)) EXPECT_EQ(offers.count(option), 1u) << option;
    EXPECT_GE(offers.size(), 3u) << verb;
  }
}

TEST_F(Completion, Zsh) {
  if (!has_program(dir, "zsh")) GTEST_SKIP() << "zsh is not installed";
  EXPECT_EQ(run_shell(dir, "/bin/sh", "zsh -n oktett.zsh").err, "");
  // The functions of zsh's completion print what they are asked for.
  const auto ask = [&](const std::string& words, int current) {
    const CommandResult result = run_shell(
        dir, "/bin/sh",
        "zsh -f -c 'function _arguments { print -rl -- $@ }; function _describe { print -rl -- ${(P)4} };"
        "words=(" +
            words + "); CURRENT=" + std::to_string(current) + "; source ./oktett.zsh'");
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return result.out;
  };
  EXPECT_TRUE(contains(ask("oktett re", 2), "render:Render a scene file or a mesh to a picture"));
  const std::string render = ask("oktett render --", 3);
  EXPECT_TRUE(contains(render, "(-o --outfile)--outfile=[Picture to write")) << render;
  EXPECT_TRUE(contains(render, ":FILE:_files")) << render;
  EXPECT_TRUE(contains(render, "(studio clay normals wire)")) << render;
  EXPECT_TRUE(contains(render, ":DIR:_files -/")) << render;
}

TEST_F(Completion, Fish) {
  if (!has_program(dir, "fish")) GTEST_SKIP() << "fish is not installed";
  EXPECT_EQ(fish("oktett re"), Offers{"render"});
  EXPECT_EQ(fish("oktett render --integr"), Offers{"--integrator"});
  EXPECT_EQ(fish("oktett render --tone a"), Offers{"aces"});
  EXPECT_EQ(fish("oktett render m"), Offers{"mesh.obj"});
  EXPECT_EQ(fish("oktett render mesh.obj --cache f"), Offers{"folder/"});
}

TEST_F(Completion, UnknownShells) {
  const CommandResult result = run_command(dir, {"completion", "tcsh"});
  EXPECT_EQ(result.status, 2);
  EXPECT_TRUE(contains(result.err, "expected bash, zsh or fish")) << result.err;
}

TEST(Manual, PagesDescribeAllOptionsWithoutWarnings) {
  const TempDir dir;
  const bool formats = has_program(dir, "groff");
  for (const char* verb : {"", "render", "view", "info", "check", "convert", "merge", "verify", "examples",
                           "completion", "manual"}) {
    const bool program = std::string(verb).empty();
    const CommandResult page = run_command(dir, program ? Words{"manual"} : Words{"manual", verb});
    ASSERT_EQ(page.status, 0) << page.err;
    EXPECT_TRUE(page.out.starts_with(".TH OKTETT")) << page.out;
    if (!formats) continue;
    dir.write("page.1", page.out);
    const CommandResult text = run_shell(dir, "/bin/sh", "groff -man -Tutf8 -ww -P-cbou page.1");
    EXPECT_EQ(text.status, 0);
    EXPECT_EQ(text.err, "") << verb;
    if (program) {
      EXPECT_TRUE(contains(text.out, "oktett-render(1)"));
    } else {
      for (const std::string& option : long_options(dir, verb))
        EXPECT_TRUE(contains(text.out, option)) << verb << " " << option;
    }
  }
  EXPECT_EQ(run_command(dir, {"manual", "nothing"}).status, 2);
}

TEST(Examples, AreListedWithWhatTheyShow) {
  const TempDir dir;
  const CommandResult list = run_command(dir, {"examples"});
  EXPECT_EQ(list.status, 0) << list.err;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(OKTETT_SOURCE_DIR) / "scenes")) {
    if (entry.path().extension() != ".yaml") continue;
    EXPECT_TRUE(contains("\n" + list.out, "\n" + entry.path().stem().string() + " ")) << entry.path();
  }
  EXPECT_TRUE(contains(list.out, "Boolean combinations of solids.")) << list.out;
}

TEST(Examples, AreCopiedWithWhatTheyNeed) {
  const TempDir dir;
  const CommandResult copied = run_command(dir, {"examples", "shapes", "torus", "pawns", "-o", "here"});
  ASSERT_EQ(copied.status, 0) << copied.err;
  for (const char* name : {"shapes.yaml", "torus.yaml", "materials.yaml", "assets/tetrahedron.obj",
                           "pawns.yaml", "assets/pawns.gltf", "assets/pawns.bin"}) {
    EXPECT_TRUE(fs::exists(dir.file("here/" + std::string(name)))) << name;
    EXPECT_TRUE(contains(copied.out, "here/" + std::string(name))) << copied.out;
  }
  const CommandResult render = run_command(
      dir, {"render", "here/shapes.yaml", "--size", "16x12", "--spp", "1", "-o", "a.png", "--quiet"});
  EXPECT_EQ(render.status, 0) << render.err;

  dir.write("here/torus.yaml", "mine");
  const CommandResult again = run_command(dir, {"examples", "torus", "-o", "here"});
  EXPECT_EQ(again.status, 1);
  EXPECT_TRUE(contains(again.err, "here/torus.yaml: the file exists; --force replaces it")) << again.err;
  EXPECT_EQ(test::file_content(dir.file("here/torus.yaml")), "mine");
  EXPECT_EQ(run_command(dir, {"examples", "torus", "-o", "here", "--force"}).status, 0);
  EXPECT_NE(test::file_content(dir.file("here/torus.yaml")), "mine");
}

TEST(Examples, MisspeltNames) {
  const TempDir dir;
  const CommandResult result = run_command(dir, {"examples", "whited"});
  EXPECT_EQ(result.status, 2);
  EXPECT_TRUE(contains(result.err, "there is no example 'whited'; did you mean 'whitted'?")) << result.err;
}

}  // namespace
}  // namespace oktett::description_command_test
