#pragma once
/// \file Shapes as text in scene files, by the descriptions of their parameters. Within io/ only.

#include <fmt/format.h>

#include <span>
#include <string>
#include <string_view>

#include "render/scene.h"

namespace oktett {

/// Files beside a scene file. Each function writes a file and returns its name without the folder. They throw
/// Error of kind io.
class SideFiles {
 public:
  explicit SideFiles(std::string scene_path) : scene_path_(std::move(scene_path)) {}

  std::string mesh(const TriangleMesh& mesh);
  std::string heights(const HeightGrid& grid);

 private:
  /// The path of the next file.
  std::string next(const char* extension);

  std::string scene_path_;
  int count_ = 0;
};

/// Writes `text` to the file `path`. Throws Error of kind io.
void write_text(const std::string& path, std::string_view text);

/// A number that reads back as itself.
inline std::string number_text(double v) { return fmt::format("{}", v); }
std::string vector_text(const Vec3d& v);
/// {matrix: [...]}.
std::string transform_text(const Affine& map);
/// A function as compile_function reads it. Throws Error if it is too long for a scene file.
std::string function_text(const FunctionTape& tape,
                          std::span<const std::string_view> variables = kSpaceVariables);

/// `key: value` of a shape, e.g. "torus: {major: 1, minor: 0.25, normals: gradient}". Not for combinations
/// and instances.
std::string shape_text(const Shape& shape, SideFiles& files);

}  // namespace oktett
