// Image files of the formats that are read most; the first byte chooses the format.

#include "core/error.h"
#include "io/image/image.h"
#include "tests/fuzz/input.h"

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
