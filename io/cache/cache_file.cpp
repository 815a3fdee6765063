#include "io/cache/cache_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "core/bytes.h"
#include "core/error.h"
#include "io/image/output.h"

namespace oktett {
namespace {

/// Begins every file; the number is the version of the format.
constexpr std::string_view kMagic = "oktett cache 2\n";
/// A multiple of the page size of every system.
constexpr std::uint64_t kAlign = 65536;
constexpr std::uint64_t kMostHeader = std::uint64_t{1} << 28;

std::uint64_t aligned(std::uint64_t place) { return (place + kAlign - 1) / kAlign * kAlign; }

/// Reads up to `size` bytes at `place`.
std::string read_bytes(int file, std::uint64_t place, std::size_t size) {
  std::string bytes(size, '\0');
  std::size_t done = 0;
  while (done < size) {
    const ssize_t n = pread(file, bytes.data() + done, size - done, static_cast<off_t>(place + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    done += static_cast<std::size_t>(n);
  }
  bytes.resize(done);
  return bytes;
}

}  // namespace

std::int64_t nanoseconds(const timespec& time) {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

std::uint64_t cache_file_bytes(std::string_view header, std::span<const CacheSection> sections) {
  std::uint64_t place = kMagic.size() + 8 + 4 + 16 * sections.size() + header.size() + 8;
  for (const CacheSection& section : sections)
    if (section.bytes > 0) place = aligned(place) + section.bytes;
  return place;
}

void write_cache_file(const std::string& path, std::string_view header,
                      std::span<const CacheSection> sections, std::int64_t time) {
  OutputFile file(path);
  std::string all;
  append_number(all, static_cast<std::uint32_t>(sections.size()));
  for (const CacheSection& section : sections) {
    append_number(all, std::uint64_t{section.bytes});
    append_number(all, block_checksum(section.data, section.bytes));
  }
  all += header;
  std::string start(kMagic);
  append_number(start, std::uint64_t{all.size()});
  file.write(start);
  file.write(all);
  start.clear();
  append_number(start, checksum(all));
  file.write(start);
  for (const CacheSection& section : sections) {
    if (section.bytes == 0) continue;
    file.seek(aligned(file.place()));
    file.write({static_cast<const char*>(section.data), section.bytes});
  }
  // What the system loses in a crash has a wrong checksum.
  file.commit_unflushed(time);
}

CacheFile::CacheFile(const std::string& path) : path_(path) {
  file_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file_ < 0)
    throw Error(Location{path}, "cannot read: " + std::generic_category().message(errno), ErrorKind::io);
  try {
    read_header();
  } catch (...) {
    close(file_);
    throw;
  }
}

CacheFile::~CacheFile() { close(file_); }

void CacheFile::fail(const std::string& message) const { throw Error(Location{path_}, message); }

void CacheFile::read_header() {
  struct stat status {};
  if (fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) fail("is not a regular file");
  time_ = nanoseconds(status.st_mtim);
  const auto size = static_cast<std::uint64_t>(status.st_size);
  constexpr std::size_t kStart = kMagic.size() + 8;
  const std::string start = read_bytes(file_, 0, kStart);
  if (start.size() < kStart || !start.starts_with(kMagic)) fail("is not of this version");
  const auto length = ByteReader(std::string_view(start).substr(kMagic.size())).number<std::uint64_t>();
  if (length > kMostHeader || length + 8 > size - kStart) fail("is cut short");
  const std::string bytes = read_bytes(file_, kStart, length + 8);
  if (bytes.size() != length + 8) fail("is cut short");
  const std::string_view all = std::string_view(bytes).substr(0, length);
  if (ByteReader(std::string_view(bytes).substr(length)).number<std::uint64_t>() != checksum(all))
    fail("is damaged");
  try {
    ByteReader reader(all);
    std::uint64_t place = kStart + length + 8;
    for (std::uint32_t left = reader.count(16); left > 0; --left) {
      Entry entry{reader.number<std::uint64_t>(), reader.number<std::uint64_t>(), place};
      if (entry.bytes > 0) entry.place = aligned(place);
      if (entry.bytes > size || entry.place > size - entry.bytes) fail("is cut short");
      place = entry.place + entry.bytes;
      sections_.push_back(entry);
    }
    if (place != size) fail("has not the length that it says");
    header_ = reader.take(reader.left());
  } catch (const Error& error) {
    if (!error.where().file.empty()) throw;
    fail(error.what());
  }
}

void CacheFile::touch() const { futimens(file_, nullptr); }

std::size_t CacheFile::section_bytes(std::size_t section) const {
  if (section >= sections_.size()) fail("has too few sections");
  return sections_[section].bytes;
}

void CacheFile::map_to(std::size_t section, void* memory) const {
  const Entry& entry = sections_[section];
  if (entry.bytes == 0) return;
  if (mmap(memory, entry.bytes, PROT_READ, MAP_PRIVATE | MAP_FIXED, file_, static_cast<off_t>(entry.place)) ==
      MAP_FAILED)
    fail("cannot be mapped: " + std::generic_category().message(errno));
  madvise(memory, entry.bytes, MADV_WILLNEED);
  if (block_checksum(memory, entry.bytes) != entry.checksum) fail("is damaged");
}

void CacheFile::copy_to(std::size_t section, void* memory) const {
  const Entry& entry = sections_[section];
  if (entry.bytes == 0) return;
  void* const from =
      mmap(nullptr, entry.bytes, PROT_READ, MAP_PRIVATE, file_, static_cast<off_t>(entry.place));
  if (from == MAP_FAILED) fail("cannot be mapped: " + std::generic_category().message(errno));
  madvise(from, entry.bytes, MADV_WILLNEED);
  const std::uint64_t sum = copy_with_checksum(from, memory, entry.bytes);
  munmap(from, entry.bytes);
  if (sum != entry.checksum) fail("is damaged");
}

}  // namespace oktett
