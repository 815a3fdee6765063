#pragma once
/// \file Times and counts of a render, as text and as JSON.

#include <string>

#include "render/render.h"

namespace oktett {

/// Wall-clock seconds of the stages of the command.
struct StageTimes {
  double load = 0, build = 0, render = 0, write = 0;
};

/// "load 0.012 s, build 0.345 s, render 1.23 s (12.3 Mrays/s), write 0.056 s".
std::string times_text(const StageTimes& times, const RenderReport& report);
/// A table of counts, one per line.
std::string stats_text(const RenderReport& report);
/// The same counts and the times as one JSON object on one line. `output` is the picture that was written.
std::string stats_json(const StageTimes& times, const RenderReport& report, const std::string& output);

}  // namespace oktett
