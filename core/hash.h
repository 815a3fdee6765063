#pragma once
/// \file A hash of a sequence of numbers, the same on every machine.

#include <bit>
#include <cstdint>

#include "core/random.h"
#include "core/vec3.h"

namespace oktett {

/// Takes numbers in and gives 64 bits that depend on all of them and on their order.
class Hasher {
 public:
  void add(std::uint64_t bits) { state_ = mix_bits((state_ ^ bits) + kGoldenBits); }
  void add(float x) { add(std::uint64_t{std::bit_cast<std::uint32_t>(x)}); }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
  void add(const Vec3f& v) { add(v.x), add(v.y), add(v.z); }

  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0;
};

}  // namespace oktett
