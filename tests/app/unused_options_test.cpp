/// \file Options that would be ignored, or silently be others, are refused or warned of.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/app/run_command.h"
#include "tests/support/temp_dir.h"

namespace oktett::unused_options_test {
namespace {

using test::CommandResult;
using test::contains;
using test::kBall;
using test::run_command;
using test::TempDir;
using Words = std::vector<std::string>;

class UnusedOptions : public testing::Test {
 protected:
  UnusedOptions() { dir_.write("ball.yaml", kBall); }

  CommandResult render(Words words, const std::string& scene = "ball.yaml") const {
    words.insert(words.begin(), {"render", scene, "--quiet", "--size", "4x4"});
    return run_command(dir_, words);
  }
  /// Refused in one line that begins with `message`, before anything is written.
  void expect_refused(const Words& words, const std::string& message,
                      const std::string& scene = "ball.yaml") {
    const CommandResult result = render(words, scene);
    EXPECT_EQ(result.status, 2) << message;
    EXPECT_EQ(result.err, "oktett: " + message + "\n");
    EXPECT_FALSE(std::filesystem::exists(dir_.file("a.png")) || std::filesystem::exists(dir_.file("a.film")));
  }
  /// The picture is made, and `warning` is all that is said.
  void expect_said(const Words& words, const std::string& warning, const std::string& scene = "ball.yaml") {
    const CommandResult result = render(words, scene);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, warning);
    for (const char* file : {"a.png", "a.exr", "a.HDR", "a.film"}) std::filesystem::remove(dir_.file(file));
  }

  TempDir dir_;
};

TEST_F(UnusedOptions, MattesNeedAFileThatHoldsThem) {
  const std::string refusal =
      "--cryptomatte needs an EXR file, the only one that holds mattes; expected -o FILE.exr";
  for (const char* file : {"a.png", "a.hdr", "a.jpg"}) expect_refused({"--cryptomatte", "-o", file}, refusal);
  expect_refused({"--cryptomatte"}, refusal);
  expect_refused({"--cryptomatte", "--no-output"}, refusal);
  expect_refused({"--cryptomatte", "-o", "a.png", "--checkpoint", "a.film"}, refusal);
  expect_said({"--cryptomatte", "-o", "a.exr"}, "");
  expect_said({"--cryptomatte", "-o", "a.film"}, "");
  // A scene asks for mattes of the EXR files that are made of it, if any are.
  dir_.write("mattes.yaml", "oktett: 1\nfilm: {cryptomatte: true}\nobjects: [{sphere: {}}]\n");
  expect_said({"-o", "a.png"}, "", "mattes.yaml");
}

TEST_F(UnusedOptions, MostSamplesNeedAnError) {
  const std::string refusal =
      "--max-spp is for adaptive sampling; expected --error, too, or 'error' in the scene";
  expect_refused({"--max-spp", "64", "-o", "a.png"}, refusal);
  expect_refused({"--max-spp", "64", "--error", "0", "-o", "a.png"}, refusal);
  expect_said({"--max-spp", "64", "--error", "0.1", "-o", "a.png"}, "");
  dir_.write("error.yaml", "oktett: 1\nintegrator: {error: 0.1, samples: 4}\nobjects: [{sphere: {}}]\n");
  expect_said({"--max-spp", "64", "-o", "a.png"}, "", "error.yaml");
}

TEST_F(UnusedOptions, MostSamplesAreNotLessThanTheFirst) {
  const Words adaptive{"--error", "0.1", "-o", "a.png"};
  const auto with = [&](Words words) {
    words.insert(words.end(), adaptive.begin(), adaptive.end());
    return words;
  };
  expect_refused(with({"--max-spp", "2", "--spp", "4"}),
                 "--max-spp: 2 is less than the 4 samples that every pixel gets first (--spp)");
  // Also the default.
  expect_refused(with({"--spp", "1025"}),
                 "--max-spp: 1024 is less than the 1025 samples that every pixel gets first (--spp)");
  expect_said(with({"--spp", "4", "--max-spp", "7"}),
              "warning: --error has no effect: after 4 samples the next step is 8, but --max-spp is 7\n");
  expect_said(with({"--spp", "4", "--max-spp", "8"}), "");
  // Numbers of the scene's own are no business of the command line, unless it changes one of them.
  dir_.write("a.yaml",
             "oktett: 1\nintegrator: {error: 0.1, samples: 4, max_samples: 3}\nobjects: [{sphere: {}}]\n");
  expect_said({"-o", "a.png"},
              "a.yaml:2:21: warning: 'error' has no effect: pixels get 4 samples or at least twice as many, "
              "but 'max_samples' is 3\n",
              "a.yaml");
}

TEST_F(UnusedOptions, CausticsNeedPaths) {
  const std::string refusal = "--caustics needs the integrator 'path'";
  expect_refused({"--caustics", "-o", "a.png"}, refusal);
  expect_said({"--caustics", "--integrator", "path", "-o", "a.png"}, "");
  const CommandResult viewer = run_command(dir_, {"view", "ball.yaml", "--caustics", "--no-open"});
  EXPECT_EQ(viewer.status, 2);
  EXPECT_EQ(viewer.err, "oktett: " + refusal + "\n");
}

TEST_F(UnusedOptions, DenoisingNeedsAPicture) {
  expect_refused({"--denoise", "-o", "a.film"},
                 "--denoise: a film keeps the noise; expected it at oktett merge, which makes the picture");
  expect_refused({"--denoise", "--shard", "1/2"},
                 "--denoise: a film keeps the noise; expected it at oktett merge, which makes the picture");
  expect_refused({"--denoise", "--no-output"},
                 "--denoise: there is no picture to smooth; expected --outfile or --show");
  EXPECT_EQ(render({"--denoise", "--no-output", "--show=blocks"}).status, 0);
  expect_said({"--denoise", "-o", "a.png"}, "");
}

TEST_F(UnusedOptions, ToneIsForEightBits) {
  const std::string tone = "warning: --tone has no effect on EXR and HDR files, which keep the light\n",
                    exposure =
                        "warning: --exposure has no effect on EXR and HDR files, which keep the light\n";
  expect_said({"--tone", "aces", "--exposure", "1", "-o", "a.exr"}, tone + exposure);
  expect_said({"--tone", "aces", "-o", "a.HDR"}, tone);
  expect_said({"--tone", "aces", "--exposure", "1", "-o", "a.png"}, "");
  expect_said({"--exposure", "1", "-o", "a.exr", "--show=blocks"}, "");
  // A film keeps both for the picture that is made of it.
  expect_said({"--tone", "aces", "--exposure", "1", "-o", "a.film"}, "");
  ASSERT_EQ(render({"-o", "b.film"}).status, 0);
  EXPECT_EQ(run_command(dir_, {"merge", "b.film", "--exposure", "1", "-o", "b.exr"}).err, exposure);
}

}  // namespace
}  // namespace oktett::unused_options_test
