#!/usr/bin/env bash
# CLI11 takes --frame 0010 for frame 8, and refuses --frame 0008.
#
# One would guess: a whole number with leading zeros is decimal, as for scanf("%d"), atoi, Python's int() and std::from_chars.
# What happens: CLI11 2.1.2 guesses the base as C source does: 0010 is octal, 8, without a word. 0008 is no octal number and
# an error. The same text as a floating-point option is 10. CLI11 2.4.1 of Debian 13 does the same.
# Why a user of a ray tracer meets it: frames are numbered with zeros so that files sort, and a loop passes the number of the file on to
# the renderer. Frames 1 to 7 are right, 8 and 9 fail, and 0010 to 0017 are rendered as 8 to 15.
#
# Needs Debian 12, g++ and the network. Debian 12: libcli11-dev 2.1.2+ds-1; Debian 13: libcli11-dev 2.4.1+ds-2. About 40 seconds.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >frame.cpp <<'CPP'
#include <CLI/CLI.hpp>
int main(int argc, char** argv) {
  CLI::App app;
  int frame = 0;
  double time = 0;
  app.add_option("--frame", frame);
  app.add_option("--time", time);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::puts(error.what());
    return 1;
  }
  std::printf("frame %d time %g\n", frame, time);
}
CPP
guess "frame 10 and frame 8"
for release in "bookworm 2.1.2+ds-1" "trixie 2.4.1+ds-2"; do
  unpack "${release% *}" amd64 "libcli11-dev=${release#* }"
  mkdir "${release% *}"
  cp -r "$root/usr/include/CLI" "${release% *}"
  g++ -std=c++17 -I"${release% *}" frame.cpp -o frame
  seen "--frame 0007" "frame 7 time 0" "$(./frame --frame 0007 || true)"
  seen "--frame 0008" "Could not convert: --frame = 0008" "$(./frame --frame 0008 || true)"
  seen "--frame 0010" "frame 8 time 0" "$(./frame --frame 0010 || true)"
  seen "--time 0010" "frame 0 time 10" "$(./frame --time 0010 || true)"
done
finish
