#include "app/gltf_words.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <string_view>

#include "app/text.h"
#include "core/description.h"
#include "core/error.h"

namespace oktett {

static constexpr int kMostFrames = 1000000;

void add_gltf_options(Verb& verb, GltfWords& words, bool moves) {
  verb.option("--time", &words.time, "SECONDS", "Show the animations of a glTF file at this time");
  if (moves)
    verb.option("--shutter", &words.shutter, "SECONDS", "With --time: how long things move in the picture");
  verb.option("--variant", &words.variant, "NAME", "Materials of this variant of a glTF file");
}

void add_stroke_option(Verb& verb, GltfWords& words) {
  verb.option("--stroke-width", &words.stroke_width, "LENGTH", "Width of points and lines of meshes");
}

void add_frame_options(Verb& verb, FrameWords& words) {
  verb.option("--frames", &words.frames, "A-B", "Render pictures A to B of a glTF file's animations");
  verb.option("--fps", &words.rate, "N", "Pictures per second of --frames; default: 24");
}

Frames frames_of(const FrameWords& words) {
  Frames frames;
  const std::string_view text = words.frames;
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos || !parse_number(text.substr(0, dash), frames.first) ||
      !parse_number(text.substr(dash + 1), frames.last) || frames.first < 0 || frames.last < frames.first ||
      frames.last > kMostFrames)
    throw Error(fmt::format("--frames: expected two numbers as in 0-47, at most {}, found '{}'", kMostFrames,
                            words.frames));
  if (!words.rate.empty() && (!parse_number(words.rate, frames.rate) || !(frames.rate > 0)))
    throw Error(fmt::format("--fps: expected pictures per second, found '{}'", words.rate));
  return frames;
}

std::string frame_path(const std::string& path, int number) {
  const std::filesystem::path whole(path);
  const std::string name =
      fmt::format("{}_{:04}{}", whole.stem().string(), number, whole.extension().string());
  return (whole.parent_path() / name).string();
}

static double seconds_of(const char* option, const std::string& word) {
  double seconds = 0;
  if (!parse_number(word, seconds) || !(std::abs(seconds) <= 1e9))
    throw Error(fmt::format("{}: expected seconds, found '{}'", option, word));
  return seconds;
}

GltfOptions gltf_options(const GltfWords& words) {
  GltfOptions options;
  options.variant = words.variant;
  const std::string& width = words.stroke_width;
  if (!width.empty() &&
      !(parse_number(width, options.stroke_width) && kPositive.contains(options.stroke_width)))
    throw Error(fmt::format("--stroke-width: expected a length greater than 0 and at most {:g}, found '{}'",
                            kMaxCoordinate, width));
  if (!words.time.empty()) options.time = seconds_of("--time", words.time);
  if (words.shutter.empty()) return options;
  if (!options.time) throw Error("--shutter needs --time or --frames");
  options.shutter = seconds_of("--shutter", words.shutter);
  if (options.shutter < 0) throw Error("--shutter: expected seconds of at least 0");
  return options;
}

}  // namespace oktett
