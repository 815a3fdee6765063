#pragma once
/// \file The decisions of a sample that are made at random, each with numbers of its own.

#include <cstdint>

namespace oktett {

/// What is decided at random. Those after `film` are made anew at each bounce.
enum class Decision : std::uint32_t {
  film,         ///< the place in the pixel
  hole,         ///< whether a ray passes through a surface that is partly a hole
  lobe,         ///< which part of the material sends the ray on
  direction,    ///< where it goes
  light,        ///< which light is asked
  light_place,  ///< which place on that light
  roulette,     ///< whether the path ends
  count
};

/// The dimension of a decision at bounce `level`: 0 is the surface that the camera ray meets.
constexpr std::uint32_t dimension(Decision decision, unsigned level = 0) {
  constexpr auto per_level = static_cast<std::uint32_t>(Decision::count) - 1;
  return static_cast<std::uint32_t>(decision) + level * per_level;
}

/// The dimension of the place on the lens. Paths of any length leave it free.
inline constexpr std::uint32_t kLensDimension = 0xffffffffu;

/// Decisions that only paths in media make. Their dimensions lie beyond those of all others, so that media in
/// one place do not change the random numbers elsewhere.
enum class MediumDecision : std::uint32_t {
  passage,   ///< how far a path goes, and by which colour channel that is decided
  tracking,  ///< what happens at the places in between
  shadow,    ///< the same for the ray to a light
  count
};

constexpr std::uint32_t dimension(MediumDecision decision, unsigned level) {
  return (1u << 20) + static_cast<std::uint32_t>(decision) +
         level * static_cast<std::uint32_t>(MediumDecision::count);
}

/// The dimension of the choice of a colour channel, likewise of its own: few materials disperse light.
constexpr std::uint32_t dispersion_dimension(unsigned level) { return (1u << 21) + level; }

}  // namespace oktett
