#pragma once
/// \file The finished picture of a render, on the terminal.

#include <cstdio>
#include <string>

#include "app/command_line.h"
#include "app/terminal/encoder.h"
#include "app/terminal/fit.h"
#include "render/picture.h"

namespace oktett {

/// The option --show: `format` is empty if it is not given.
void add_show_option(Verb& verb, std::string& format);

/// Prints pictures on a terminal. Made before the render, so that what is missing is known by then.
class TerminalPreview {
 public:
  /// `format`: what --show asks for; "auto" is the best format that the terminal has, and needs one. `to` is
  /// standard output or standard error. Throws Error for an unknown format, for a stream that is no terminal
  /// and for a terminal without colours, and if what encodes pictures is not there.
  TerminalPreview(const std::string& format, std::FILE* to);

  /// Prints `picture`, as its PNG would show it, as large as the terminal now has room for, and ends the
  /// line.
  void print(const Picture& picture) const;

 private:
  std::FILE* to_;
  const TerminalEncoder* encoder_ = nullptr;
  TerminalFormat format_ = TerminalFormat::blocks;
};

}  // namespace oktett
