#include <pybind11/pybind11.h>
#include <stdlib.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "io/image/encode.h"
#include "io/image/texture.h"
#include "io/text/files.h"
#include "python/src/files.h"

namespace oktett::python {
namespace {

namespace fs = std::filesystem;

/// Writes files to a folder of their own, which goes with the object.
class TemporaryFiles {
 public:
  explicit TemporaryFiles(const FileContents& files) {
    if (files.empty()) return;
    std::string pattern = (fs::temp_directory_path() / "oktett-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr)
      throw Error("cannot make a folder for files: " + std::generic_category().message(errno), ErrorKind::io);
    folder_ = pattern;
    for (const auto& [name, content] : files) {
      // OpenImageIO asks for the end of the name.
      const fs::path path = folder_ / (std::to_string(paths_.size()) + fs::path(name).extension().string());
      std::ofstream file(path, std::ios::binary);
      file.write(content.data(), static_cast<std::streamsize>(content.size()));
      file.close();
      if (!file) throw Error(Location{path.string()}, "cannot write", ErrorKind::io);
      paths_.emplace(name, path.string());
    }
  }
  ~TemporaryFiles() {
    std::error_code ignored;
    if (!folder_.empty()) fs::remove_all(folder_, ignored);
  }
  TemporaryFiles(const TemporaryFiles&) = delete;
  TemporaryFiles& operator=(const TemporaryFiles&) = delete;

  const std::map<std::string, std::string>& paths() const { return paths_; }

 private:
  fs::path folder_;
  std::map<std::string, std::string> paths_;
};

class FilesOfIo final : public Files {
 public:
  SceneRead read(const std::string& path, const Definitions& definitions,
                 const FileContents& contents) const override {
    // Files are noted, and stood in for, for one scene at a time.
    static std::mutex reading;
    const std::lock_guard lock(reading);
    const FilesRead noted;
    const TemporaryFiles temporary(contents);
    const StandIns stand_ins(temporary.paths());
    SceneRead result;
    result.scene = load_scene(path, definitions);
    // What stands in for images is gone later.
    if (!contents.empty()) result.textures = textures(result.scene.textures);
    std::set<std::string> paths;
    for (const std::string& name : noted.paths()) paths.insert(name);
    for (const Texture& texture : result.scene.textures)
      if (!texture.path.empty()) paths.insert(texture.path);
    for (const std::string& name : paths)
      if (!contents.contains(name)) result.paths.push_back(name);
    return result;
  }

  std::shared_ptr<const TextureSampler> textures(std::vector<Texture> textures) const override {
    return std::make_shared<const ImageTextures>(std::move(textures));
  }

  std::string png(const Picture& picture) const override { return encode_png(picture, {}); }
};

}  // namespace

PYBIND11_MODULE(_files, module) {
  static const FilesOfIo files;
  const Files* const entry = &files;
  module.doc() = "The part of oktett that reads and writes files.";
  module.attr(kFilesEntry) = pybind11::capsule(entry, kFilesEntry);
}

}  // namespace oktett::python
