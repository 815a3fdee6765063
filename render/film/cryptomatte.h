#pragma once
/// \file Cryptomatte: which objects and materials cover a pixel, and how much (Friedman and Jones 2015,
/// "Cryptomatte specification" 1.2.0).

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
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
  struct Entry {
    float id;
    std::uint32_t count;
  };

  void add(float id);
  /// Appends an id that is not there yet.
  void append(float id, std::uint32_t count) { entries_.push_back({id, count}); }
  /// In the order in which they came.
  const std::vector<Entry>& entries() const { return entries_; }
  /// Writes ids and their parts of `samples`, those of the greatest parts first, to the planes of one layer
  /// from `first` on at pixel `at`.
  void write(Picture& picture, std::size_t first, std::size_t at, std::uint32_t samples) const;

 private:
  std::vector<Entry> entries_;
};

/// The layers of objects and of materials.
inline constexpr const char *kObjectLayer = "CryptoObject", *kMaterialLayer = "CryptoMaterial";

/// Adds the planes of both layers, empty, to a picture.
void add_matte_planes(Picture& picture);

/// The first plane of a layer in a picture; the number of its planes if it has none.
std::size_t first_matte_plane(const Picture& picture, const char* layer);

/// The ids of a world's objects and materials, numbered as in World, and what a picture says of them.
struct Mattes {
  std::vector<float> objects, materials;
  std::vector<std::pair<std::string, std::string>> attributes;  ///< see Picture::attributes
};

/// Those of a world. An object without a name is called object and its number, as in geomID.I, a material
/// without one material and its number.
Mattes mattes_of(const World& world);

}  // namespace oktett
