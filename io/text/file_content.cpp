#include "io/text/file_content.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <new>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "core/pages.h"
#include "io/text/files.h"

namespace oktett {

namespace {

[[noreturn]] void fail(const std::string& path, const std::string& why) {
  throw Error(Location{path}, "cannot read: " + why, ErrorKind::io);
}

[[noreturn]] void fail_with_errno(const std::string& path) {
  const int error = errno;
  fail(path, std::generic_category().message(error) + (error == ENOENT ? did_you_mean_file(path) : ""));
}

class Descriptor {
 public:
  // Without O_NONBLOCK, opening a pipe that nobody writes to would never return.
  explicit Descriptor(const std::string& path) : fd_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

}  // namespace

MappedFile::MappedFile(const std::string& path) {
  note_file_read(path);
  const Descriptor file(path_to_open(path));
  struct stat status;
  if (file.get() < 0 || fstat(file.get(), &status) != 0) fail_with_errno(path);
  if (const std::string why = why_unreadable(file.get()); !why.empty()) fail(path, "it " + why);
  size_ = static_cast<std::size_t>(status.st_size);

  // The file is laid over the front of zero pages: what follows it in its last page reads as zero too.
  const std::size_t page = page_size();
  const std::size_t file_pages = (size_ + page - 1) / page * page;
  reserved_ = file_pages + page;
  void* base = mmap(nullptr, reserved_, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (base == MAP_FAILED) fail_with_errno(path);
  data_ = static_cast<char*>(base);
  if (size_ == 0) return;
  if (mmap(base, size_, PROT_READ, MAP_PRIVATE | MAP_FIXED, file.get(), 0) == MAP_FAILED) {
    const int error = errno;
    munmap(base, reserved_);
    errno = error;
    fail_with_errno(path);
  }
  madvise(base, size_, MADV_SEQUENTIAL);
}

MappedFile::~MappedFile() { munmap(data_, reserved_); }

void MappedFile::release(const char* begin, const char* end) const {
  const std::size_t page = page_size();
  const std::size_t first = (static_cast<std::size_t>(begin - data_) + page - 1) / page * page;
  const std::size_t last = static_cast<std::size_t>(end - data_) / page * page;
  if (first < last) madvise(data_ + first, last - first, MADV_DONTNEED);
}

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

FileContent::FileContent(const std::string& path) {
  mapped_.emplace(path);
  if (!is_packed(path)) return;
  unpacked_.emplace(unpack_gzip(path, mapped_->text(), kPadding));
  mapped_.reset();
}

std::string_view FileContent::text() const {
  return unpacked_ ? std::string_view{unpacked_->data(), unpacked_->size} : mapped_->text();
}

void FileContent::release(const char* begin, const char* end) const {
  if (mapped_) mapped_->release(begin, end);
}

}  // namespace oktett
