#include "app/terminal/encoder.h"

#include "app/own_library.h"
#include "core/error.h"

namespace oktett {

#ifdef OKTETT_TERMINAL_LIBRARY
const TerminalEncoder& terminal_encoder() {
  static const auto get =
      reinterpret_cast<GetTerminalEncoder>(load_own_library(OKTETT_TERMINAL_LIBRARY, kTerminalEncoderSymbol));
  return *get();
}
#else
const TerminalEncoder& terminal_encoder() {
  throw Error(
      "--show: this build shows no pictures on terminals: chafa (libchafa-dev) was missing when it was made");
}
#endif

}  // namespace oktett
