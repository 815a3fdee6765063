#pragma once
/// \file Exact surfaces against their oracles.

#include <cstdint>
#include <string>
#include <vector>

#include "core/isa.h"
#include "verify/oracles/exact.h"

namespace oktett {

/// Rays against one shape: a camera's worth, so that beams and packets are formed.
inline constexpr std::size_t kRaysPerShape = 512;

/// Counts over the rays shot at one form.
struct ExactTally {
  std::uint64_t rays = 0, hits = 0;
  std::uint64_t missed = 0;       ///< a first crossing that the oracle finds and the tracer does not
  std::uint64_t invented = 0;     ///< a hit where the function does not change its sign
  std::uint64_t touched = 0;      ///< of those, allowed: the function all but touches zero there
  std::uint64_t creased = 0;      ///< hits at an edge or a tip finer than the position's error bound
  std::uint64_t off_surface = 0;  ///< position, moved by its error bound, is not off the surface to that side
  std::uint64_t lists = 0;        ///< all_hits disagrees with the oracle's crossings
  std::uint64_t differing = 0;    ///< a mode, width or instruction set gave other bits
  std::uint64_t uncertified = 0;  ///< answers, in any mode, that took too many steps to be proved
  double worst_residual = 0;      ///< |f| at a hit over what its error bound allows
  std::string failure;            ///< the first one
  std::uint64_t trial = 0;        ///< where that was: the shape's number

  std::uint64_t wrong() const { return missed + invented + off_surface + lists + differing + uncertified; }
};

/// Form number `form` of draw_exact_oracles: `rays` rays spread over shapes of random parameters and
/// transforms, which are numbered from `first`; half of the rays leave the surfaces that others have hit. A
/// function of its arguments alone.
ExactTally verify_exact(std::size_t form, std::uint64_t rays, const std::vector<Isa>& isas,
                        std::uint64_t first = 0);

/// The shape of a trial and where it stands.
struct ExactTrial {
  ExactOracle oracle;
  Affine to_world;
};
ExactTrial exact_trial(std::size_t form, std::uint64_t trial);

}  // namespace oktett
