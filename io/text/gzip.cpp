#include "io/text/gzip.h"

#include <sys/mman.h>
#include <zlib.h>

#include <algorithm>
#include <new>
#include <utility>

#include "core/error.h"
#include "core/pages.h"

namespace oktett {
namespace {

/// The least room for what a file unpacks to.
constexpr std::size_t kLeastRoom = 4096;
/// zlib counts in 32 bits.
constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;

std::size_t in_pages(std::size_t bytes) { return pages_around(0, bytes, page_size()).bytes; }

/// The state of zlib.
class Inflate {
 public:
  Inflate() {
    // 15 bits of window, and 16 for the wrapping of gzip alone.
    if (inflateInit2(&stream, 15 + 16) != Z_OK) throw std::bad_alloc();
  }
  ~Inflate() { inflateEnd(&stream); }
  Inflate(const Inflate&) = delete;
  Inflate& operator=(const Inflate&) = delete;

  z_stream stream{};
};

class Unpacking {
 public:
  Unpacking(const std::string& path, std::string_view packed, std::size_t padding)
      : path_(path),
        packed_(packed),
        padding_(padding),
        bytes_(std::max(4 * packed.size(), kLeastRoom) + padding) {}

  UnpackedBytes run() {
    if (packed_.empty()) fail("the file is empty");
    while (read_ < packed_.size()) {
      if (packed_[read_] == '\0' && read_ > 0) {
        expect_zeros();
        break;
      }
      unpack_member();
      inflateReset(&zlib_.stream);
    }
    bytes_.resize(bytes_.size + padding_);
    return std::move(bytes_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(Location{path_}, "cannot be unpacked: " + what);
  }

  void unpack_member() {
    z_stream& stream = zlib_.stream;
    int state = Z_OK;
    while (state != Z_STREAM_END) {
      const std::size_t given = std::min(packed_.size() - read_, kMostAtOnce);
      const std::size_t room = std::min(bytes_.capacity() - padding_ - bytes_.size, kMostAtOnce);
      // The interface of zlib lacks a const.
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed_.data() + read_));
      stream.avail_in = static_cast<uInt>(given);
      stream.next_out = reinterpret_cast<Bytef*>(bytes_.data() + bytes_.size);
      stream.avail_out = static_cast<uInt>(room);
      state = inflate(&stream, Z_NO_FLUSH);
      read_ += given - stream.avail_in, bytes_.size += room - stream.avail_out;
      if (state == Z_MEM_ERROR) throw std::bad_alloc();
      if (state != Z_OK && state != Z_STREAM_END && state != Z_BUF_ERROR) fail_at(stream.msg);
      const std::size_t most = most_unpacked(packed_.size());
      if (bytes_.size > most)
        fail("it holds more than " + std::to_string(most) + " bytes, too many for a file of " +
             std::to_string(packed_.size()));
      if (state != Z_STREAM_END && stream.avail_out == 0)
        bytes_.resize(std::min(2 * bytes_.capacity(), most + 1 + padding_));
      else if (state != Z_STREAM_END && read_ == packed_.size())
        fail("the file ends at byte " + std::to_string(packed_.size()) + ", before its data do");
    }
  }

  [[noreturn]] void fail_at(const char* why) const {
    fail("byte " + std::to_string(read_) + ": " + (why != nullptr ? why : "damaged data"));
  }

  /// Tapes are filled up with zeros.
  void expect_zeros() const {
    const std::size_t other = packed_.find_first_not_of('\0', read_);
    if (other != std::string_view::npos)
      fail("byte " + std::to_string(other) + ": something else follows the data");
  }

  const std::string& path_;
  const std::string_view packed_;
  const std::size_t padding_;
  std::size_t read_ = 0;
  Inflate zlib_;
  UnpackedBytes bytes_;
};

}  // namespace

UnpackedBytes::UnpackedBytes(std::size_t capacity) : capacity_(in_pages(capacity)) {
  void* const p = mmap(nullptr, capacity_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (p == MAP_FAILED) throw std::bad_alloc();
  data_ = static_cast<char*>(p);
}

UnpackedBytes::~UnpackedBytes() {
  if (data_ != nullptr) munmap(data_, capacity_);
}

UnpackedBytes::UnpackedBytes(UnpackedBytes&& other) noexcept
    : size(other.size),
      data_(std::exchange(other.data_, nullptr)),
      capacity_(std::exchange(other.capacity_, 0)) {}

void UnpackedBytes::resize(std::size_t capacity) {
  capacity = in_pages(capacity);
  void* const p = mremap(data_, capacity_, capacity, MREMAP_MAYMOVE);
  if (p == MAP_FAILED) throw std::bad_alloc();
  data_ = static_cast<char*>(p), capacity_ = capacity;
}

UnpackedBytes unpack_gzip(const std::string& path, std::string_view packed, std::size_t padding) {
  return Unpacking(path, packed, padding).run();
}

}  // namespace oktett
