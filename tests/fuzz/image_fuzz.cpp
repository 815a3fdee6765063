// Image files of the formats that are read most; the first byte chooses the format.

#include "core/error.h"
#include "io/image/image.h"
#include "tests/fuzz/input.h"

// OpenImageIO 2.4 loses the text of an error when libpng leaves its reader by longjmp. The leak can be told
// from others only by whole call stacks.
extern "C" const char* __lsan_default_suppressions() { return "leak:PngReadCallback\n"; }
extern "C" const char* __asan_default_options() { return "fast_unwind_on_malloc=0"; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  static test::InputFile files[] = {test::InputFile("a.png"), test::InputFile("a.exr"),
                                    test::InputFile("a.hdr"), test::InputFile("a.ppm")};
  test::InputBytes bytes(data, size);
  test::InputFile& file = files[bytes.take<std::uint8_t>() % 4];
  try {
    (void)read_image(file.write(bytes.rest()));
  } catch (const Error& e) {
    test::require(*e.what() != 0, "an error says something");
  }
  return 0;
}
