#pragma once
/// \file Writing scene files: the objects of a scene with exactly their numbers.

#include <string>

#include "render/scene.h"

namespace oktett {

/// Writes the camera, the prototypes and the objects of `scene` as a scene file, with a camera near the
/// origin if it has none but lies far away. load_scene_file reads the same shapes, transforms and names back,
/// number by number. The positions and triangles of meshes and the samples of height fields go to files
/// beside it, whose names begin with that of the file. Materials, lights, textures, media and motions are
/// left out. Each line of `comment` stands at the top behind '#'.
///
/// Throws Error of kind io if a file cannot be written, of kind bad_input for what no scene file can hold: a
/// function of more than 16384 characters.
void write_scene_file(const std::string& path, const Scene& scene, const std::string& comment = "");

}  // namespace oktett
