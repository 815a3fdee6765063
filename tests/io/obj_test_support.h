#pragma once
/// \file Loading OBJ and MTL files from text, for their tests.

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/obj/obj.h"
#include "io/obj/parsed_obj.h"
#include "tests/support/temp_dir.h"

namespace oktett::test {

template <class T>
std::vector<T> to_vector(const Column<T>& column) {
  return {column.begin(), column.end()};
}

/// A directory with files for one test.
class ObjFiles {
 public:
  /// Writes `text` as mesh.obj and loads it.
  ObjFile load(const std::string& text, const ObjOptions& options = {}) const {
    return load_obj(write("mesh.obj", text), options);
  }

  /// Writes a file anew. Some file systems take long to write over one that is there.
  std::string write(const std::string& name, const std::string& text) const {
    std::filesystem::remove(dir.file(name));
    return dir.write(name, text);
  }

  /// The error message without the directory's path, or "no error".
  std::string error(const std::string& text, const ObjOptions& options = {}) const {
    try {
      load(text, options);
    } catch (const Error& e) {
      return without_directory(e.what());
    }
    return "no error";
  }

  /// The warnings of a file that loads, without the directory's path.
  std::vector<std::string> warnings(const std::string& text) const { return as_text(load(text).warnings); }
  std::vector<std::string> as_text(const std::vector<Warning>& warnings) const {
    std::vector<std::string> lines;
    for (const Warning& warning : warnings) lines.push_back(without_directory(to_string(warning)));
    return lines;
  }

  std::string without_directory(std::string message) const {
    const std::string prefix = dir.path().string() + "/";
    for (std::size_t at; (at = message.find(prefix)) != std::string::npos;) message.erase(at, prefix.size());
    return message;
  }

  TempDir dir;
};

inline std::vector<std::uint32_t> indices_of(const ObjFile& file) { return to_vector(file.mesh.indices); }

/// Four corners of a square, which most tests build on.
inline const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

using Indices = std::vector<std::uint32_t>;

}  // namespace oktett::test
