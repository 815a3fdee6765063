#include "io/image/library.h"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <new>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/error.h"
#include "core/pages.h"
#include "io/text/file_content.h"
#include "io/text/files.h"

namespace oktett {

namespace fs = std::filesystem;

namespace {

/// Folders to look in, relative to that of the file which holds this code (see own_file).
constexpr const char* kPlaces[] = {
    OKTETT_LIBRARIES_FROM_PROGRAMS,  // an installed program
    "../lib",                        // a program in its build folder
    ".",                             // a shared Oktett, beside its library of images
#ifdef OKTETT_BUILT_LIBRARIES
    OKTETT_BUILT_LIBRARIES,  // a program of another project that builds Oktett as a part
#endif
};

/// The file that holds this code: the program, or liboktett.so if Oktett is a shared library.
fs::path own_file() {
  std::error_code error;
#ifdef OKTETT_SHARED
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&own_file), &info) != 0 && info.dli_fname != nullptr)
    return fs::weakly_canonical(info.dli_fname, error);
#endif
  return fs::read_symlink("/proc/self/exe", error);
}

/// The folders in which the dynamic linker looks for libraries, run paths first. The folders of its cache
/// (ld.so.cache) are not among them.
std::vector<fs::path> system_folders() {
  std::vector<fs::path> folders;
#ifdef __GLIBC__
  Dl_info info{};
  void* self = nullptr;
  if (dladdr1(reinterpret_cast<const void*>(&own_file), &info, &self, RTLD_DL_LINKMAP) == 0) return folders;
  Dl_serinfo size{};
  if (dlinfo(self, RTLD_DI_SERINFOSIZE, &size) != 0) return folders;
  std::vector<std::max_align_t> room(size.dls_size / sizeof(std::max_align_t) + 1);
  auto* const list = reinterpret_cast<Dl_serinfo*>(room.data());
  if (dlinfo(self, RTLD_DI_SERINFOSIZE, list) != 0 || dlinfo(self, RTLD_DI_SERINFO, list) != 0)
    return folders;
  const Dl_serpath* const paths = list->dls_serpath;
  for (unsigned i = 0; i < list->dls_cnt; ++i) folders.emplace_back(paths[i].dls_name);
#endif
  return folders;
}

bool can_read(const fs::path& file) { return access(file.c_str(), R_OK) == 0; }

/// The path of the library's file, or nothing if it is in none of the folders known here.
fs::path find_file() {
  const fs::path own = own_file();
  for (const char* place : kPlaces) {
    const fs::path file = (own.parent_path() / place / OKTETT_IMAGE_LIBRARY).lexically_normal();
    if (!own.empty() && can_read(file)) return file;
  }
  for (const fs::path& folder : system_folders())
    if (can_read(folder / OKTETT_IMAGE_LIBRARY)) return folder / OKTETT_IMAGE_LIBRARY;
  return {};
}

/// Among the libraries that come along are some whose constructors start threads, and wait for ever where the
/// system refuses one. So nothing is loaded where less address space than this is left.
constexpr std::size_t kNeededSpace = std::size_t{512} << 20;

const ImageLibrary* load() {
  if (!can_reserve(kNeededSpace)) throw std::bad_alloc();
  // Without a path, the dynamic linker searches by name, its cache included.
  const fs::path found = find_file();
  const std::string name = found.empty() ? std::string(OKTETT_IMAGE_LIBRARY) : found.string();
  const auto fail = [] {
    const char* why = dlerror();
    // The dynamic linker tells by words alone that it was refused memory.
    for (const char* sign : {"annot allocate memory", "failed to map segment", "out of memory"})
      if (why != nullptr && std::string_view(why).find(sign) != std::string_view::npos)
        throw std::bad_alloc();
    throw Error(std::string("cannot load ") + OKTETT_IMAGE_LIBRARY +
                    ", which reads and writes images: " + (why != nullptr ? why : "unknown reason"),
                ErrorKind::io);
  };
  // RTLD_LAZY: only the functions that are called are looked up, few of those in 250 libraries.
  // RTLD_NODELETE: objects that the library made may outlive every handle, and their destructors are in it.
  void* const library = dlopen(name.c_str(), RTLD_LAZY | RTLD_LOCAL | RTLD_NODELETE);
  if (library == nullptr) fail();
  void* const entry = dlsym(library, kImageLibraryEntry);
  if (entry == nullptr) fail();
  return reinterpret_cast<ImageLibraryEntry>(entry)();
}

}  // namespace

const ImageLibrary& image_library() {
  static const ImageLibrary* const library = load();
  return *library;
}

bool image_library_is_installed() { return !find_file().empty(); }

namespace {

using namespace std::string_view_literals;

/// How files of EXR, PNG, JPEG, TIFF, Radiance HDR, BMP and PNM begin.
constexpr std::string_view kBeginnings[] = {"\x76\x2f\x31\x01"sv,
                                            "\x89PNG\r\n"sv,
                                            "\xff\xd8\xff"sv,
                                            "II*\0"sv,
                                            "MM\0*"sv,
                                            "II+\0"sv,
                                            "MM\0+"sv,
                                            "#?RADIANCE"sv,
                                            "#?RGBE"sv,
                                            "BM"sv,
                                            "P1"sv,
                                            "P2"sv,
                                            "P3"sv,
                                            "P4"sv,
                                            "P5"sv,
                                            "P6"sv};

bool is_usual(const std::string& path) {
  const MappedFile file(path);
  const std::string_view text = file.text();
  if (text.starts_with("RIFF") && text.substr(8).starts_with("WEBP")) return true;
  return std::ranges::any_of(kBeginnings, [&](std::string_view b) { return text.starts_with(b); });
}

/// Whether an EXR file is as long as its header says of the attributes. OpenEXR asks for the memory of a text
/// before it looks. True for files of other formats.
bool holds_its_attributes(std::string_view text) {
  if (!text.starts_with(kBeginnings[0]) || text.size() < 8) return true;
  const bool has_parts = (static_cast<unsigned char>(text[5]) & 0x10) != 0;
  text.remove_prefix(8);
  const auto skip_name = [&] {
    const std::size_t end = text.find('\0');
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  };
  while (!text.empty()) {
    if (text.front() == '\0') {
      text.remove_prefix(1);
      // The headers of the parts end with an empty one.
      if (!has_parts || text.empty() || text.front() == '\0') return true;
      continue;
    }
    skip_name(), skip_name();
    std::uint32_t size = 0;
    if (text.size() < sizeof size) return true;
    std::memcpy(&size, text.data(), sizeof size);
    text.remove_prefix(sizeof size);
    if (size > text.size()) return false;
    text.remove_prefix(size);
  }
  return true;
}

}  // namespace

std::string why_not_an_image(const std::string& path) {
  std::string why = why_unreadable(path);
  if (why.empty() && files_are_confined() && !is_usual(path))
    why = "begins like none of the image formats that may be read here";
  if (why.empty() && !holds_its_attributes(MappedFile(path).text()))
    why = "cannot read the image: an attribute in its header is longer than the file";
  return why;
}

std::string image_to_open(const std::string& path) {
  note_file_read(path);
  if (const std::string why = why_not_an_image(path); !why.empty())
    throw Error(Location{path}, why, ErrorKind::io);
  return path_to_open(path);
}

}  // namespace oktett
