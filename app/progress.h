#pragma once
/// \file The progress line.

#include <chrono>
#include <string>

#include "core/phase.h"
#include "render/picture/render.h"

namespace oktett {

/// One line on stderr: percent, elapsed, remaining, rays/s. On a terminal it is rewritten in place;
/// elsewhere, if asked for, a line is added at most once a second.
class ProgressLine {
 public:
  enum class Mode { automatic, always, never };
  explicit ProgressLine(Mode mode);
  ~ProgressLine() { finish(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const RenderProgress& progress);
  /// Leaves room for a message: on a terminal, clears the line.
  void clear();
  /// Shows the last state if it was not shown yet, and ends the line.
  void finish();

 private:
  void print(const RenderProgress& progress);

  const bool terminal_;
  const bool shown_;  ///< anything is shown at all
  bool line_open_ = false;
  bool held_back_ = false;
  RenderProgress last_;
  std::chrono::steady_clock::time_point next_{};
};

/// While it exists, a line on stderr shows what loading and building are busy with, if stderr is a terminal.
/// Only one may exist at a time.
class PhaseLine {
 public:
  explicit PhaseLine(bool quiet);
  ~PhaseLine() { end(); }
  PhaseLine(const PhaseLine&) = delete;
  PhaseLine& operator=(const PhaseLine&) = delete;

  /// Clears the line; nothing is shown any more.
  void end();

 private:
  bool shown_;
};

/// "reading bunny.obj   42.0%  elapsed 1.2 s  remaining 1.7 s"; without a total only what has elapsed.
std::string phase_text(const PhaseState& state);

/// " 42.0%  elapsed 1.2 s  remaining 1.7 s  12.3 Mrays/s".
std::string progress_text(const RenderProgress& progress);

}  // namespace oktett
