#pragma once
/// \file What the tests of conversions of mesh files share.

#include <string>
#include <vector>

#include "io/mesh/save/convert_mesh.h"
#include "tests/io/mesh_test_support.h"

namespace oktett::test {

/// What a conversion says that it has lost.
using Losses = std::vector<std::string>;

/// Files in a folder of their own that are converted into each other.
class Convert : public testing::Test {
 protected:
  Losses convert(const std::string& from, const std::string& to, const ConvertOptions& options = {}) const {
    return convert_mesh(files.dir.file(from), files.dir.file(to), options).losses;
  }
  MeshFile load(const std::string& name) const { return load_mesh(files.dir.file(name)); }
  std::string error(const std::string& from, const std::string& to,
                    const ConvertOptions& options = {}) const {
    try {
      check_mesh_output(files.dir.file(to), options);
      convert(from, to, options);
    } catch (const Error& e) {
      return files.without_directory(e.what());
    }
    return "no error";
  }

  ObjFiles files;
};

}  // namespace oktett::test
