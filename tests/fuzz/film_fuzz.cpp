// Films of checkpoints and shares in files.

#include "core/error.h"
#include "io/film/film_file.h"
#include "tests/fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  static test::InputFile file("a.film");
  try {
    (void)read_film(file.write({reinterpret_cast<const char*>(data), size}));
  } catch (const Error& e) {
    test::require(*e.what() != 0 && !e.where().file.empty(), "an error names the file");
  }
  return 0;
}
