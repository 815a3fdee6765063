#include <pybind11/pybind11.h>

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "core/error.h"
#include "io/image/encode.h"
#include "io/image/texture.h"
#include "io/text/files.h"
#include "python/src/files.h"

namespace oktett::python {
namespace {

namespace fs = std::filesystem;

/// Writes files to `folder`; returns their paths by their names.
std::map<std::string, std::string> write_files(const FileContents& files, const PrivateFolder& folder) {
  std::map<std::string, std::string> paths;
  for (const auto& [name, content] : files) {
    // OpenImageIO asks for the end of the name.
    const std::string number = std::to_string(paths.size());
    paths.emplace(name, folder.write(number + fs::path(name).extension().string(), content).string());
  }
  return paths;
}

class FilesOfIo final : public Files {
 public:
  SceneRead read(const std::string& path, const Definitions& definitions,
                 const FileContents& contents) const override {
    // Files are noted, and stood in for, for one scene at a time.
    static std::mutex reading;
    const std::lock_guard lock(reading);
    const FilesRead noted;
    std::optional<PrivateFolder> folder;
    if (!contents.empty()) folder.emplace();
    const StandIns stand_ins(folder ? write_files(contents, *folder) : std::map<std::string, std::string>());
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
