#pragma once
/// \file Cryptomatte: which objects and materials cover a pixel, and how much (Friedman and Jones 2015,
/// "Cryptomatte specification" 1.2.0).

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "render/geometry.h"
#include "render/picture.h"

namespace oktett {

/// Names that cover a pixel beyond the first so many are left out.
inline constexpr int kMatteLevels = 6;

/// MurmurHash3_x86_32 with seed 0 (Appleby).
std::uint32_t murmur_hash(std::string_view text);

/// The id of a name: its hash as the bits of a float, where bits that make no normal number are changed.
float matte_id(std::string_view name);

/// How often each id covers a pixel.
class MatteSums {
 public:
  void add(float id);
  /// Writes ids and their parts of `samples`, those of the greatest parts first, to the planes of one layer
  /// from `first` on at pixel `at`.
  void write(Picture& picture, std::size_t first, std::size_t at, std::uint32_t samples) const;

 private:
  struct Entry {
    float id;
    std::uint32_t count;
  };
  std::vector<Entry> entries_;
};

/// The ids of a world's objects and materials, and where a picture keeps their layers.
struct Mattes {
  std::vector<float> objects, materials;               ///< numbered as in World
  std::size_t object_planes = 0, material_planes = 0;  ///< the first plane of each layer
};

/// Adds the planes of the layers CryptoObject and CryptoMaterial, empty, and their attributes to a picture.
/// Instances show the objects of their prototype. An object without a name is called object and its number,
/// as in geomID.I, a material without one material and its number.
Mattes add_mattes(const World& world, Picture& picture);

}  // namespace oktett
