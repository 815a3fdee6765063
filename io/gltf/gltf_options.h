#pragma once
/// \file What can be asked of glTF files, and of meshes.

#include <optional>
#include <string>

namespace oktett {

/// What of a glTF file is shown.
struct GltfOptions {
  /// Seconds from the start of the animations; nothing: all is where the file places it without them.
  std::optional<double> time;
  /// Seconds for which things move from then on.
  double shutter = 0;
  std::string variant;      ///< of KHR_materials_variants; empty: none
  double stroke_width = 0;  ///< of points and lines, also of other meshes; 0: by the size of what is shown

  /// Whether something is asked that only glTF files have.
  bool is_for_gltf() const { return time || shutter != 0 || !variant.empty(); }
  bool operator==(const GltfOptions&) const = default;
};

}  // namespace oktett
