#include "app/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

#include "app/text.h"

namespace oktett {

namespace {

/// Names of files may hold anything, also what moves a terminal's cursor. Shortened to a line.
std::string printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
  return text.substr(0, 200);
}

}  // namespace

std::string progress_text(const RenderProgress& progress) {
  const double done = static_cast<double>(progress.pixels_done);
  const double total = static_cast<double>(progress.pixels_total);
  const double fraction = total > 0 ? done / total : 1;
  std::string text = fmt::format("{:5.1f}%  elapsed {}", 100 * fraction, duration_text(progress.seconds));
  if (done > 0) text += "  remaining " + duration_text(progress.seconds * (total - done) / done);
  if (progress.seconds > 0)
    text += "  " + with_prefix(static_cast<double>(progress.rays) / progress.seconds) + "rays/s";
  return text;
}

std::string phase_text(const PhaseState& state) {
  std::string text = state.kind;
  if (!state.what.empty()) text += " " + state.what;
  const double done = static_cast<double>(state.done), total = static_cast<double>(state.total);
  if (total > 0) text += fmt::format("  {:5.1f}%", 100 * done / total);
  if (state.seconds > 0) text += "  elapsed " + duration_text(state.seconds);
  if (total > 0 && done > 0) text += "  remaining " + duration_text(state.seconds * (total - done) / done);
  return text;
}

PhaseLine::PhaseLine(bool quiet) : shown_(!quiet && isatty(STDERR_FILENO) == 1) {
  if (shown_)
    watch_phases([](const PhaseState& state) {
      say("\r{}\x1b[K", printable(phase_text(state)));
      std::fflush(stderr);
    });
}

void PhaseLine::end() {
  if (!std::exchange(shown_, false)) return;
  watch_phases({});
  say("\r\x1b[K");
}

ProgressLine::ProgressLine(Mode mode)
    : terminal_(isatty(STDERR_FILENO) == 1),
      shown_(mode == Mode::always || (mode == Mode::automatic && terminal_)) {}

void ProgressLine::show(const RenderProgress& progress) {
  if (!shown_) return;
  last_ = progress;
  const auto now = std::chrono::steady_clock::now();
  held_back_ = !terminal_ && now < next_;
  if (held_back_) return;
  next_ = now + std::chrono::seconds(1);
  print(progress);
}

void ProgressLine::print(const RenderProgress& progress) {
  // The escape sequence clears the rest of a longer previous line.
  say("{}{}{}", terminal_ ? "\r" : "", progress_text(progress), terminal_ ? "\x1b[K" : "\n");
  std::fflush(stderr);
  line_open_ = terminal_;
}

void ProgressLine::clear() {
  if (line_open_) say("\r\x1b[K");
  line_open_ = false;
}

void ProgressLine::finish() {
  if (held_back_) print(last_);
  held_back_ = false;
  if (line_open_) say("\n");
  line_open_ = false;
}

}  // namespace oktett
