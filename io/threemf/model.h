#pragma once
/// \file What a 3MF file says, and the shared library that knows lib3mf, liboktett_threemf. Within
/// io/threemf/ only.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "core/soa.h"
#include "core/transform.h"
#include "core/vec3.h"
#include "render/material.h"

namespace oktett {

/// Components of components may multiply: a short file would show any number of meshes.
inline constexpr std::uint64_t kMostThreeMfShown = 1'000'000;
inline constexpr int kMostThreeMfLevels = 64;

/// How triangles look: as a base material, as an image, or as the colours of their corners.
struct ThreeMfLook {
  enum class Kind : std::uint8_t { base, image, colors };
  Kind kind = Kind::base;
  std::string name;
  std::array<std::uint8_t, 4> rgba{255, 255, 255, 255};  ///< of a base material: sRGB and alpha
  std::uint32_t image = kNoId;
};

struct ThreeMfImage {
  std::string path;     ///< in the package
  std::string content;  ///< of the PNG or JPEG file
  TextureLookup lookup{};
};

/// An object in a place.
struct ThreeMfPart {
  std::uint32_t object = 0;
  Affine place;
};

/// A mesh, or other objects, which stand before it in the list.
struct ThreeMfObject {
  std::string name;
  Column<Vec3f> positions;
  Column<std::uint32_t> indices;
  std::vector<std::uint32_t> looks;  ///< per triangle, kNoId: none; empty if no triangle has one
  Column<std::uint8_t> colors;       ///< four per corner, white where there are none; or empty
  Column<Vec2f> uvs;                 ///< per corner, zeros where there is no image; or empty
  std::vector<ThreeMfPart> parts;
};

struct ThreeMfModel {
  const char* unit = "millimeter";
  std::vector<ThreeMfLook> looks;
  std::vector<ThreeMfImage> images;
  std::vector<ThreeMfObject> objects;
  std::vector<ThreeMfPart> build;
  std::vector<std::string> warnings;
};

class ThreeMfLibrary {
 public:
  /// Reads the bytes of a file, which messages call `path`. Its parts may unpack to most_unpacked. Indices
  /// of vertices may be out of range. Throws Error.
  virtual ThreeMfModel read(const std::string& path, std::string_view bytes) const = 0;

 protected:
  ~ThreeMfLibrary() = default;
};

/// What the library shows, by its name for dlsym.
inline constexpr const char* kThreeMfLibraryEntry = "oktett_threemf_library";
using ThreeMfLibraryEntry = const ThreeMfLibrary* (*)();

}  // namespace oktett
