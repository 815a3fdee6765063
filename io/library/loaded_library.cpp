#include "io/library/loaded_library.h"

#include <dlfcn.h>
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/error.h"
#include "core/pages.h"

namespace oktett {

namespace fs = std::filesystem;

namespace {

/// Folders to look in, relative to that of the file which holds this code (see own_file).
constexpr const char* kPlaces[] = {
    OKTETT_LIBRARIES_FROM_PROGRAMS,  // an installed program
    "../lib",                        // a program in its build folder
    ".",                             // a shared Oktett, beside its libraries
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
fs::path find_library(const char* name) {
  const fs::path own = own_file();
  for (const char* place : kPlaces) {
    const fs::path file = (own.parent_path() / place / name).lexically_normal();
    if (!own.empty() && can_read(file)) return file;
  }
  for (const fs::path& folder : system_folders())
    if (can_read(folder / name)) return folder / name;
  return {};
}

}  // namespace

void* load_library(const LoadedLibrary& library) {
  if (!can_reserve(library.needed_space)) throw std::bad_alloc();
  // Without a path, the dynamic linker searches by name, its cache included.
  const fs::path found = find_library(library.file);
  const std::string name = found.empty() ? std::string(library.file) : found.string();
  const auto fail = [&] {
    const char* why = dlerror();
    // The dynamic linker tells by words alone that it was refused memory.
    for (const char* sign : {"annot allocate memory", "failed to map segment", "out of memory"})
      if (why != nullptr && std::string_view(why).find(sign) != std::string_view::npos)
        throw std::bad_alloc();
    throw Error(std::string("cannot load ") + library.file + ", which " + library.purpose + ": " +
                    (why != nullptr ? why : "unknown reason"),
                ErrorKind::io);
  };
  // RTLD_LAZY: only the functions that are called are looked up, few of those in 250 libraries.
  // RTLD_NODELETE: objects that the library made may outlive every handle, and their destructors are in it.
  void* const handle = dlopen(name.c_str(), RTLD_LAZY | RTLD_LOCAL | RTLD_NODELETE);
  if (handle == nullptr) fail();
  void* const entry = dlsym(handle, library.entry);
  if (entry == nullptr) fail();
  return entry;
}

bool is_installed(const LoadedLibrary& library) { return !find_library(library.file).empty(); }

}  // namespace oktett
