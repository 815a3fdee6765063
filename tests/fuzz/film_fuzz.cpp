// Films of checkpoints and shares. Checksums are mended first, so that changes of what they cover are read,
// too.

#include <string>

#include "core/bytes.h"
#include "core/error.h"
#include "io/film/film_file.h"
#include "tests/fuzz/input.h"

namespace oktett {
namespace {

/// Goes through a film as io/film/film_file.cpp lays it out and puts the right checksums where some are.
class FilmMender {
 public:
  explicit FilmMender(std::string& bytes) : bytes_(bytes) {}

  void mend() {
    const std::uint64_t header = length_at(kMagic.size());
    at_ = kMagic.size() + 8;
    if (!mend_piece(header, 0)) return;
    while (bytes_.size() - at_ >= kRecordHeader) {
      const std::uint64_t start = checksum(piece(kRecordHeader)), sums = length_at(at_ + 8);
      at_ += kRecordHeader;
      if (!mend_piece(sums, start)) return;
    }
  }

 private:
  static constexpr std::string_view kMagic = "oktett film 2\n";
  static constexpr std::size_t kRecordHeader = 16;

  std::string_view piece(std::size_t size) const { return std::string_view(bytes_).substr(at_, size); }

  /// The number at `at`; 0 if the film ends before.
  std::uint64_t length_at(std::size_t at) const {
    std::uint64_t length = 0;
    if (at + 8 <= bytes_.size()) std::memcpy(&length, bytes_.data() + at, 8);
    return length;
  }

  /// Mends the checksum behind the next `size` bytes. Returns whether the film goes so far.
  bool mend_piece(std::uint64_t size, std::uint64_t before) {
    if (at_ > bytes_.size() || size > bytes_.size() - at_ || bytes_.size() - at_ - size < 8) return false;
    const std::uint64_t sum = before ^ checksum(piece(size));
    std::memcpy(bytes_.data() + at_ + size, &sum, 8);
    at_ += size + 8;
    return true;
  }

  std::string& bytes_;
  std::size_t at_ = 0;
};

}  // namespace
}  // namespace oktett

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace oktett;
  std::string bytes(reinterpret_cast<const char*>(data), size);
  FilmMender(bytes).mend();
  try {
    (void)parse_film(bytes);
  } catch (const Error& e) {
    test::require(*e.what() != 0, "an error says something");
  }
  return 0;
}
