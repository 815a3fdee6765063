#include "io/image/library.h"

#include <dlfcn.h>
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <system_error>
#include <vector>

namespace oktett {

namespace fs = std::filesystem;

namespace {

/// Where to look, from the folder of what this code is part of.
constexpr const char* kPlaces[] = {
    OKTETT_LIBRARIES_FROM_PROGRAMS,  // an installed program
    "../lib",                        // one that was only built
    ".",                             // a shared library beside its like
#ifdef OKTETT_BUILT_LIBRARIES
    OKTETT_BUILT_LIBRARIES,  // a program of a project that Oktett is a part of
#endif
};

/// The file that this code is part of: a program, or Oktett itself where that is a shared library.
fs::path own_file() {
  std::error_code error;
#ifdef OKTETT_SHARED
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&own_file), &info) != 0 && info.dli_fname != nullptr)
    return fs::weakly_canonical(info.dli_fname, error);
#endif
  return fs::read_symlink("/proc/self/exe", error);
}

/// Where the system looks for libraries that this code asks for, run paths first; without what its cache
/// adds.
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

/// The path of the library's file, or nothing if only the system may know it.
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

const ImageLibrary* load() {
  // What is found by name alone is found as the system finds all libraries.
  const fs::path found = find_file();
  const std::string name = found.empty() ? std::string(OKTETT_IMAGE_LIBRARY) : found.string();
  const auto fail = [] {
    const char* why = dlerror();
    throw Error(std::string("cannot load ") + OKTETT_IMAGE_LIBRARY +
                    ", which reads and writes images: " + (why != nullptr ? why : "unknown reason"),
                ErrorKind::io);
  };
  // Lazy, as programs are linked: of all those libraries few functions are called. It stays: objects with
  // code of its own outlive any call.
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

}  // namespace oktett
