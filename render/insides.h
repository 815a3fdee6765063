#pragma once
/// \file The solids that a ray is in, as far as they matter for what fills its way in Whitted's model.

#include <cstdint>

#include "accel/accel.h"
#include "render/geometry.h"

namespace oktett {

/// Solids that a ray has entered and not left, at most four; of more the first is forgotten. Each is an entry
/// of 16 bits, the innermost lowest; 0 is none.
class Insides {
 public:
  static constexpr std::uint16_t kEntered = 0x4000;  ///< set in every entry
  static constexpr std::uint16_t kClosed = 0x8000;   ///< what is outside of the solid is not in it
  /// The rest is the number of a medium and 1, or 0 if there is none.
  static constexpr std::uint32_t kMostMedia = 0x3ffe;

  void enter(std::uint16_t entry) { bits_ = bits_ << 16 | entry; }
  /// Takes away this entry, the innermost of several; the innermost of all if there is none like it.
  void leave(std::uint16_t entry);
  /// Whether what is outside of all solids is around the ray, too.
  bool is_open() const;
  /// Calls f(number) for each medium that the ray is in.
  template <class F>
  void for_each_medium(F&& f) const {
    for (std::uint64_t rest = bits_; rest != 0; rest >>= 16)
      if (const auto medium = static_cast<std::uint32_t>(rest & kMostMediumBits); medium != 0) f(medium - 1);
  }
  bool empty() const { return bits_ == 0; }
  bool operator==(const Insides&) const = default;

 private:
  static constexpr std::uint64_t kMostMediumBits = 0x3fff;
  std::uint64_t bits_ = 0;
};

/// The entry of the object at a hit; 0 if it has no inside. `user` and `slot` are those of the hit's surface
/// interaction.
std::uint16_t inside_of(const World& world, const Hit& hit, std::uint32_t user, std::uint32_t slot);

/// The solids around a point.
Insides insides_at(const World& world, const Vec3f& point);

}  // namespace oktett
