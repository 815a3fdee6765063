#pragma once
/// \file What of the package knows io/, behind an interface: the compiled module oktett._files.
///
/// io/ brings the libraries that read and write YAML, EXR, PNG and glTF. Queries need none of them, so io/ is
/// in a module of its own, which is imported when the first scene is read or the first picture is encoded. It
/// shares all other code with the module oktett._oktett.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "io/scene/scene_file.h"
#include "render/material.h"
#include "render/picture.h"
#include "render/scene.h"
#include "render/texture_sampler.h"

namespace oktett::python {

/// Contents of files by name.
using FileContents = std::map<std::string, std::string>;

/// A scene, and where it comes from.
struct SceneRead {
  Scene scene;
  std::vector<std::string> paths;  ///< files that were read from the disk
  /// Null if no contents were given: then the images are still on the disk.
  std::shared_ptr<const TextureSampler> textures;
};

/// All members may be called by many threads at once, without the interpreter's lock; they throw Error.
class Files {
 public:
  /// Reads the scene file or mesh `path`, with `contents` in place of the files of their names.
  virtual SceneRead read(const std::string& path, const Definitions& definitions,
                         const FileContents& contents) const = 0;
  /// See ImageTextures.
  virtual std::shared_ptr<const TextureSampler> textures(std::vector<Texture> textures) const = 0;
  /// The bytes of a PNG file, see write_image.
  virtual std::string png(const Picture& picture) const = 0;

 protected:
  ~Files() = default;
};

/// Imports the module on the first call. With the interpreter's lock.
const Files& files();

/// The attribute of the module that holds a capsule of this name with a Files.
inline constexpr const char* kFilesEntry = "files";

}  // namespace oktett::python
