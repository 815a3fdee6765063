#include "io/threemf/lib3mf/package.h"

#include <zip.h>

#include <cstdint>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/text/file_content.h"
#include "io/threemf/lib3mf/components.h"

namespace oktett {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw Error(Location{path}, "cannot be unpacked: " + what);
}

class ZipReading {
 public:
  ZipReading(const std::string& path, std::string_view bytes) : path_(path), size_(bytes.size()) {
    zip_error_t error;
    zip_error_init(&error);
    zip_source_t* const source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
    if (source == nullptr) throw std::bad_alloc();
    archive_.reset(zip_open_from_source(source, ZIP_RDONLY | ZIP_CHECKCONS, &error));
    if (archive_) return;
    zip_source_free(source);
    const std::string why = zip_error_strerror(&error);
    zip_error_fini(&error);
    fail(path, "as a ZIP archive: " + why);
  }

  void run() {
    const zip_int64_t count = zip_get_num_entries(archive_.get(), 0);
    for (zip_int64_t i = 0; i < count; ++i) read(static_cast<zip_uint64_t>(i));
    check_components(path_, parts_);
  }

 private:
  void read(zip_uint64_t entry) {
    const char* const name = zip_get_name(archive_.get(), entry, 0);
    const std::string where = name == nullptr ? "an entry without a name" : std::string(name).substr(0, 80);
    zip_stat_t stated;
    const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(zip_fopen_index(archive_.get(), entry, 0),
                                                                 zip_fclose);
    if (name == nullptr || zip_stat_index(archive_.get(), entry, 0, &stated) != 0 || !file)
      fail(path_, where + ": " + zip_strerror(archive_.get()));
    std::string text;
    std::uint64_t own = 0;
    for (;;) {
      const zip_int64_t got = zip_fread(file.get(), buffer_.data(), buffer_.size());
      if (got < 0) fail(path_, where + ": " + zip_file_strerror(file.get()));
      if (got == 0) break;
      own += static_cast<std::uint64_t>(got);
      if (own + unpacked_ > most_unpacked(size_))
        fail(path_, "it holds more than " + std::to_string(most_unpacked(size_)) +
                        " bytes, too many for a file of " + std::to_string(size_));
      text.append(buffer_.data(), static_cast<std::size_t>(got));
    }
    if (own != stated.size)
      fail(path_,
           where + ": it has " + std::to_string(own) + " bytes, and states " + std::to_string(stated.size));
    unpacked_ += own;
    parts_.emplace_back(name, std::move(text));
  }

  const std::string& path_;
  const std::size_t size_;
  std::unique_ptr<zip_t, void (*)(zip_t*)> archive_{nullptr, zip_discard};
  std::vector<char> buffer_ = std::vector<char>(std::size_t{1} << 16);
  std::uint64_t unpacked_ = 0;
  std::vector<std::pair<std::string, std::string>> parts_;
};

}  // namespace

void check_package(const std::string& path, std::string_view bytes) { ZipReading(path, bytes).run(); }

}  // namespace oktett
