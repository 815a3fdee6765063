#pragma once
/// \file What the fuzz targets share: reading values from the bytes of an input, and files that hold them.

#include <fcntl.h>
#include <unistd.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "core/error.h"
#include "tests/support/temp_dir.h"

namespace oktett::test {

/// Ends the process, which the fuzzer counts as a finding, unless `ok`.
inline void require(bool ok, const char* what) {
  if (ok) return;
  std::fprintf(stderr, "required, but not true: %s\n", what);
  std::abort();
}

/// The bytes of an input, from first to last. After the end all bytes are 0.
class InputBytes {
 public:
  InputBytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  template <class T>
  T take() {
    unsigned char bytes[sizeof(T)] = {};
    const std::size_t n = sizeof(T) < size_ ? sizeof(T) : size_;
    std::memcpy(bytes, data_, n);
    data_ += n, size_ -= n;
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
  }

  /// Any float: by its first byte a small whole number, a multiple of 1/8, or any bits. Small numbers make
  /// points that coincide and rays that touch edges likely.
  float number() {
    const auto kind = take<std::uint8_t>();
    if (kind < 0x60) return static_cast<float>(kind % 7) - 3;
    if (kind < 0xc0) return static_cast<float>(take<std::int8_t>()) / 8;
    return std::bit_cast<float>(take<std::uint32_t>());
  }

  bool empty() const { return size_ == 0; }
  std::string_view rest() const { return {reinterpret_cast<const char*>(data_), size_}; }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

/// A file that gets other bytes again and again. It is not made anew each time, which would wait for the
/// disk.
class RewrittenFile {
 public:
  explicit RewrittenFile(const std::string& path)
      : file_(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
    require(file_ >= 0, "the file of the inputs can be written");
  }
  ~RewrittenFile() { close(file_); }
  RewrittenFile(const RewrittenFile&) = delete;
  RewrittenFile& operator=(const RewrittenFile&) = delete;

  void write(std::string_view bytes) {
    const auto size = static_cast<off_t>(bytes.size());
    require(pwrite(file_, bytes.data(), bytes.size(), 0) == size && ftruncate(file_, size) == 0,
            "there is room for the file");
  }

 private:
  int file_;
};

/// A file for inputs of readers that want a path; each input replaces the one before.
class InputFile {
 public:
  explicit InputFile(const char* name) : path_(dir_.file(name)), file_(path_) {}

  const std::string& write(std::string_view bytes) {
    file_.write(bytes);
    return path_;
  }
  const TempDir& dir() const { return dir_; }

 private:
  TempDir dir_;
  std::string path_;
  RewrittenFile file_;
};

/// Calls `read` with the path of a file `name` that holds the input. An error must have a text and name the
/// file. Returns 0, as targets do.
template <class Read>
int fuzz_reader(const char* name, const std::uint8_t* data, std::size_t size, Read read) {
  static InputFile file(name);
  try {
    read(file.write({reinterpret_cast<const char*>(data), size}));
  } catch (const Error& e) {
    require(*e.what() != 0 && !e.where().file.empty(), "an error names the file");
  }
  return 0;
}

}  // namespace oktett::test

/// What the fuzzer calls; each target has one. Returns 0.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
