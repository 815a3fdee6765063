// Files that gzip has packed.

#include "io/text/file_content.h"
#include "tests/fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  try {
    const UnpackedBytes bytes = unpack_gzip("a.gz", {reinterpret_cast<const char*>(data), size}, 64);
    test::require(bytes.size <= most_unpacked(size), "no more than the file justifies");
    for (std::size_t i = 0; i < 64; ++i)
      test::require(bytes.data()[bytes.size + i] == 0, "zeros behind the end");
  } catch (const Error& e) {
    test::require(e.where().file == "a.gz", "an error names the file");
  }
  return 0;
}
