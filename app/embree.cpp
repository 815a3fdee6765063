/// \file Running programs with this project's libraries in place of Embree's.

#include <unistd.h>

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "app/command_line.h"
#include "core/error.h"

namespace oktett {
namespace {

namespace fs = std::filesystem;

/// The folder of libembree3.so.3 and libembree4.so.4, where the build or the installation puts it.
fs::path embree_folder() {
  std::error_code error;
  const fs::path programs = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const char* place : {"../lib", OKTETT_LIBRARIES_FROM_PROGRAMS}) {
    const fs::path folder = (programs / place / "oktett-embree").lexically_normal();
    if (fs::is_directory(folder, error)) return folder;
  }
  throw Error(
      "this installation has no libraries in place of Embree's; they are built where Embree's headers are "
      "found",
      ErrorKind::io);
}

int run_embree(const std::vector<std::string>& words) {
  const fs::path folder = embree_folder();
  if (words.empty()) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
      if (!entry.is_symlink()) fmt::print("{}\n", entry.path().string());
    fmt::print("\noktett embree -- PROGRAM [WORD...] runs a program that is linked with Embree on these.\n");
    return 0;
  }
  const char* const before = std::getenv("LD_LIBRARY_PATH");
  const std::string path =
      folder.string() + (before != nullptr && *before != '\0' ? std::string(":") + before : "");
  if (setenv("LD_LIBRARY_PATH", path.c_str(), 1) != 0)
    throw Error("cannot set LD_LIBRARY_PATH", ErrorKind::io);
  std::vector<std::string> own = words;
  std::vector<char*> arguments;
  for (std::string& word : own) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execvp(arguments[0], arguments.data());
  throw Error("cannot run '" + words[0] + "': " + std::strerror(errno), ErrorKind::io);
}

}  // namespace

void add_embree_command(CommandLine& line) {
  const auto words = std::make_shared<std::vector<std::string>>();
  Verb verb = line.add_verb("embree", "Run a program that uses Embree on Oktett",
                            [words] { return run_embree(*words); });
  verb.optional_positionals("program", *words, "PROGRAM [WORD...]",
                            "The program and its words, behind --; without one the libraries are listed");
}

}  // namespace oktett
