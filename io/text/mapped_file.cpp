#include "io/text/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>

#include "core/error.h"
#include "core/pages.h"
#include "io/text/file_access.h"
#include "io/text/files_read.h"
#include "io/text/similar_file.h"
#include "io/text/stand_ins.h"

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

}  // namespace oktett
