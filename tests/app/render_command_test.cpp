#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "core/isa.h"
#include "io/image/image.h"
#include "io/scene/scene_file.h"
#include "render/picture/render.h"
#include "tests/app/run_command.h"
#include "tests/support/sanitizers.h"
#include "tests/support/temp_dir.h"

namespace oktett::render_command_test {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::contains;
using test::file_content;
using test::file_count;
using test::kBall;
using test::run_command;
using test::TempDir;

TEST(RenderCommand, StatsAreTextOrOneJsonObject) {
  const TempDir dir;
  dir.write("ball.yaml", kBall);
  const CommandResult text = run_command(dir, {"render", "ball.yaml", "--stats"});
  EXPECT_EQ(text.status, 0) << text.err;
  for (const char* word :
       {"camera", "shadow", "bytes per triangle", "sah cost", "bad samples", "bounce 0", "shading lanes"})
    EXPECT_TRUE(contains(text.out, word)) << word;
  const CommandResult json = run_command(dir, {"render", "--stats=json", "ball.yaml"});
  EXPECT_EQ(json.status, 0) << json.err;
  EXPECT_EQ(json.out.front(), '{');
  EXPECT_EQ(json.out.substr(json.out.size() - 2), "}\n");
  EXPECT_EQ(std::count(json.out.begin(), json.out.end(), '\n'), 1);
  EXPECT_TRUE(contains(json.out, "\"output\": \"ball.png\""));
  EXPECT_TRUE(contains(json.out, "\"bounces\": {\"rays\": ["));
  EXPECT_TRUE(contains(json.out, "\"lanes_filled\": ["));
  EXPECT_TRUE(contains(json.err, "wrote ball.png"));
}

// 70 hits in a tile are shaded as 64 and 6, and 6 fill a part of one vector.
TEST(RenderCommand, StatsTellWhichPartOfTheLanesIsFilled) {
  const TempDir dir;
  dir.write("wall.yaml", "oktett: 1\nobjects: [{plane: {normal: [0, 0, 1], offset: 0}}]\n");
  for (const Isa isa : available_isas()) {
    const double lanes = 64 + (isa == Isa::scalar ? 6 : isa == Isa::avx512 ? 16 : 8);
    const auto stats = [&](const char* format) {
      const CommandResult result = run_command(
          dir, {"render", "wall.yaml", "--size", "10x7", "--spp", "1", "--isa", to_string(isa), format});
      EXPECT_EQ(result.status, 0) << result.err;
      return result.out;
    };
    const std::string json = stats("--stats=json"), name = "\"lanes_filled\": [";
    const std::size_t at = json.find(name);
    ASSERT_NE(at, std::string::npos) << json;
    EXPECT_NEAR(std::strtod(json.c_str() + at + name.size(), nullptr), 70 / lanes, 1e-6) << to_string(isa);
    const std::string percent =
        std::to_string(std::lround(100 * 70 / lanes)) + " % of shading lanes filled\n";
    EXPECT_TRUE(contains(stats("--stats"), percent)) << percent;
  }
}

// Loops over frames write them with leading zeros.
TEST(RenderCommand, WholeNumbersAreDecimal) {
  const TempDir dir;
  dir.write("ball.yaml", kBall);
  std::string pictures[2];
  for (const int k : {0, 1}) {
    const CommandResult result = run_command(dir, {"render", "ball.yaml", "--spp", k == 0 ? "10" : "0010",
                                                   "--seed", k == 0 ? "8" : "08", "-o", "a.ppm"});
    ASSERT_EQ(result.status, 0) << result.err;
    pictures[k] = file_content(dir.file("a.ppm"));
  }
  EXPECT_TRUE(pictures[0] == pictures[1]);
  EXPECT_EQ(run_command(dir, {"render", "ball.yaml", "--spp", "0x10"}).status, 2);
}

// Numbers of scenes do not come from the C library, whose sine of 0.259 differs in its last bit with the
// processor: it picks another function where multiplications and additions do not fuse. The radius shows that
// bit as a whole unit.
TEST(RenderCommand, NumbersOfScenesDoNotDependOnTheCLibrary) {
  const TempDir dir;
  dir.write("ball.yaml",
            "oktett: 1\nobjects:\n  - sphere: {radius: \"1 + 1e16*abs(sin(0.259) - 0.25611403353482032)\"}\n"
            "  - implicit: {function: \"x^2 + y^2 + z^2 - 1 - 1e16*abs(sin(0.259) - 0.25611403353482032)\", "
            "bounds: {min: [-2, -2, -2], max: [2, 2, 2]}}\n");
  std::string pictures[2];
  for (const int fused : {0, 1}) {
    const std::string tunables =
        fused ? "GLIBC_TUNABLES="
              : "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX2_Usable,-FMA_Usable";
    const CommandResult result = run_command(dir,
                                             {tunables, OKTETT_COMMAND, "render", "ball.yaml", "--size",
                                              "32x24", "--spp", "1", "--isa", "scalar", "-o", "a.png"},
                                             "/usr/bin/env");
    ASSERT_EQ(result.status, 0) << result.err;
    pictures[fused] = file_content(dir.file("a.png"));
  }
  EXPECT_TRUE(pictures[0] == pictures[1]);
}

/// The plane of this name has the same bits in both pictures.
bool same_plane(const Picture& a, const std::string& in_a, const Picture& b, const std::string& in_b) {
  const PicturePlane *p = a.find(in_a), *q = b.find(in_b);
  if (p == nullptr || q == nullptr || p->values.size() != q->values.size()) return false;
  const bool same_ids = std::equal(p->ids.begin(), p->ids.end(), q->ids.begin(), q->ids.end());
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  return same_ids && std::ranges::equal(p->values, q->values, {}, bits, bits);
}

// Without --denoise the noise stays: EXR files have no layer for it, and their colours are those that
// --denoise keeps beside the smoothed ones.
TEST(RenderCommand, OnlyDenoiseSmooths) {
  const TempDir dir;
  dir.write(
      "noisy.yaml",
      "oktett: 1\nfilm: {width: 24, height: 24}\nintegrator: {kind: path, samples: 4}\nlights: [{sky: }]\n"
      "objects: [{sphere: {}}, {plane: {normal: [0, 1, 0], offset: -1}}]\n");
  ASSERT_EQ(run_command(dir, {"render", "noisy.yaml", "-o", "plain.exr"}).status, 0);
  ASSERT_EQ(run_command(dir, {"render", "noisy.yaml", "-o", "smooth.exr", "--denoise"}).status, 0);
  const Picture plain = read_image(dir.file("plain.exr")), smooth = read_image(dir.file("smooth.exr"));
  EXPECT_EQ(smooth.planes.size(), plain.planes.size() + 3);
  for (const PicturePlane& plane : plain.planes) {
    EXPECT_FALSE(plane.name.starts_with("Noisy.")) << plane.name;
    const bool is_color = plane.name == "R" || plane.name == "G" || plane.name == "B";
    EXPECT_TRUE(same_plane(plain, plane.name, smooth, (is_color ? "Noisy." : "") + plane.name)) << plane.name;
    EXPECT_EQ(same_plane(plain, plane.name, smooth, plane.name), !is_color) << plane.name;
  }
  // The same holds for files without layers: the second picture is another one.
  ASSERT_EQ(run_command(dir, {"render", "noisy.yaml", "-o", "plain.hdr"}).status, 0);
  ASSERT_EQ(run_command(dir, {"render", "noisy.yaml", "-o", "smooth.hdr", "--denoise"}).status, 0);
  EXPECT_NE(file_content(dir.file("plain.hdr")), file_content(dir.file("smooth.hdr")));
}

// Planes of the library are those of the command without --denoise.
TEST(RenderCommand, TheLibraryDoesNotDenoise) {
  const TempDir dir;
  const std::string path = dir.write("noisy.yaml",
                                     "oktett: 1\nfilm: {width: 24, height: 24}\n"
                                     "integrator: {kind: path, samples: 4}\nlights: [{sky: }]\n"
                                     "objects: [{sphere: {}}]\n");
  const Picture rendered = render(load_scene_file(path), {}).picture;
  for (const PicturePlane& plane : rendered.planes) EXPECT_FALSE(plane.name.starts_with("Noisy."));
  write_image(dir.file("library.exr"), rendered);
  ASSERT_EQ(run_command(dir, {"render", "noisy.yaml", "-o", "command.exr"}).status, 0);
  const Picture library = read_image(dir.file("library.exr")), command = read_image(dir.file("command.exr"));
  EXPECT_EQ(library.planes.size(), command.planes.size());
  for (const PicturePlane& plane : library.planes)
    EXPECT_TRUE(same_plane(library, plane.name, command, plane.name)) << plane.name;
}

TEST(RenderCommand, ProgressIsShownOnlyOnDemandWithoutATerminal) {
  const TempDir dir;
  dir.write("ball.yaml", kBall);
  EXPECT_EQ(run_command(dir, {"render", "ball.yaml"}).err, "");
  // A small picture may be done before the first report is due.
  const CommandResult result = run_command(dir, {"render", "ball.yaml", "--progress", "--size", "800x800"});
  EXPECT_EQ(result.status, 0);
  EXPECT_FALSE(contains(result.err, "\r"));
  EXPECT_EQ(run_command(dir, {"render", "ball.yaml", "--progress", "--quiet"}).err, "");
}

TEST(RenderCommand, WarnsOnceOfMaterialsThatMakeEnergyInPaths) {
  const TempDir dir;
  const std::string rest = "materials: {m: {diffuse: 3}}\nobjects: [{sphere: {}, material: m}]\n";
  dir.write("whitted.yaml", "oktett: 1\n" + rest);
  dir.write("path.yaml", "oktett: 1\nintegrator: {kind: path}\n" + rest);
  const auto warnings = [&](const std::string& scene, const std::string& kind) {
    const std::string text =
        run_command(dir, {"render", scene, "--size", "4x4", "--quiet", "--integrator", kind}).err;
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find("times the light", at)) != std::string::npos; ++at) ++count;
    return count;
  };
  EXPECT_EQ(warnings("whitted.yaml", "whitted"), 0u);
  EXPECT_EQ(warnings("whitted.yaml", "path"), 1u);
  EXPECT_EQ(warnings("path.yaml", "path"), 1u);
  EXPECT_EQ(warnings("path.yaml", "whitted"), 0u);
}

// Outputs that cannot be written are refused before any work: the scene file here does not even exist.
TEST(RenderCommand, RefusesBadOutputsFirst) {
  const TempDir dir;
  dir.write("plain", "x");
  struct Case {
    const char* outfile;
    int status;
    const char* message;
  };
  for (const Case& c : {Case{"-", 2, "standard output"},
                        {"a.xyz", 2, "known ones are .exr, .png"},
                        {"a", 2, "unknown"},
                        {"no/a.png", 1, "no directory 'no'"},
                        {"plain/a.png", 1, "no directory 'plain'"},
                        {".", 1, "is a directory"},
                        {"/proc/a.png", 1, "cannot write"}}) {
    const CommandResult result = run_command(dir, {"render", "missing.yaml", "-o", c.outfile});
    EXPECT_EQ(result.status, c.status) << c.outfile;
    EXPECT_TRUE(contains(result.err, c.message)) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
  }
  EXPECT_EQ(file_count(dir), 1u);
}

// Without what writes the format there is nothing to render for. A shared library of Oktett would lie beside
// it.
#ifndef OKTETT_SHARED
TEST(RenderCommand, MissesTheLibraryOfImagesFirst) {
  if (test::kEmulated) GTEST_SKIP() << "the emulator is told where the command lies, so no copy of it is run";
  const TempDir dir;
  fs::create_directory(dir.path() / "bin");
  const std::string alone = dir.file("bin/oktett");
  fs::copy_file(OKTETT_COMMAND, alone);
  const CommandResult result = run_command(dir, {"render", "missing.yaml", "-o", "a.jpg"}, alone);
  EXPECT_EQ(result.status, 1);
  EXPECT_TRUE(contains(result.err, "cannot load liboktett_images.so")) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);

  dir.write("ball.yaml", kBall);
  for (const char* name : {"a.png", "a.exr"})
    EXPECT_EQ(run_command(dir, {"render", "ball.yaml", "-o", name}, alone).status, 0);
  fs::copy(fs::path(OKTETT_COMMAND).parent_path().parent_path() / "lib", dir.path() / "lib");
  EXPECT_EQ(run_command(dir, {"render", "ball.yaml", "-o", "a.jpg"}, alone).status, 0);
  EXPECT_TRUE(fs::exists(dir.path() / "a.jpg"));
}
#endif

TEST(RenderCommand, ABadSceneLeavesTheOldPicture) {
  const TempDir dir;
  dir.write("bad.yaml", "oktett: 1\nwidth: 3\n");
  dir.write("bad.png", "old");
  EXPECT_EQ(run_command(dir, {"render", "bad.yaml"}).status, 2);
  EXPECT_EQ(file_content(dir.file("bad.png")), "old");
  EXPECT_EQ(file_count(dir), 2u);
}

TEST(RenderCommand, WarningsAreBounded) {
  const TempDir dir;
  std::string scene = kBall;
  for (int i = 0; i < 30; ++i) scene += "  - sphere: {radius: 0}\n";
  dir.write("many.yaml", scene);
  const CommandResult bounded = run_command(dir, {"render", "many.yaml"});
  EXPECT_EQ(bounded.status, 0) << bounded.err;
  EXPECT_EQ(bounded.err.substr(0, 17), "many.yaml:7:5: wa") << bounded.err;
  EXPECT_TRUE(contains(bounded.err, "... and 10 more warnings"));
  EXPECT_EQ(std::count(bounded.err.begin(), bounded.err.end(), '\n'), 21);
  EXPECT_FALSE(contains(run_command(dir, {"render", "many.yaml", "-v"}).err, "more warnings"));
}

TEST(RenderCommand, AnAbsentDisplayServerIsAWarning) {
  const TempDir dir;
  dir.write("ball.yaml", kBall);
  const CommandResult result = run_command(dir, {"render", "ball.yaml", "--display-server", "127.0.0.1:1"});
  EXPECT_EQ(result.status, 0);
  EXPECT_TRUE(contains(result.err, "warning: no live preview")) << result.err;
  EXPECT_TRUE(fs::exists(dir.file("ball.png")));
  EXPECT_EQ(run_command(dir, {"render", "ball.yaml", "--display-server", "a:b"}).status, 2);
}

}  // namespace
}  // namespace oktett::render_command_test
