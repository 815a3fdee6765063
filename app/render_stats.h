#pragma once
/// \file What `oktett render` tells at its end: times, and counts with --stats.

#include <cstdint>
#include <string>

#include "app/render_options.h"
#include "render/picture/render.h"

namespace oktett {

/// Wall-clock seconds of the stages of the command, and what is known of no other report.
struct StageTimes {
  double load = 0, build = 0, render = 0, denoise = 0, write = 0;
  std::uint64_t given_up = 0;  ///< searches for a hit that would have taken too many steps
};

/// Prints the times, what --stats asks for, and warnings about samples and searches that failed. `output` is
/// the picture that was written; empty: none.
void print_summary(const RenderArguments& arguments, const StageTimes& times, const RenderReport& report,
                   const std::string& output);

}  // namespace oktett
